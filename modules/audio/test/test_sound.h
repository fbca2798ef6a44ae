#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "mien/base/random.h"
#include "test_paths.h"

namespace mien {

inline std::filesystem::path shared_audio() { return shared_path("audio"); }

/// Noise of changing loudness with silent stretches: speech-like enough for features.
inline std::vector<float> babble(std::size_t num_samples, std::uint64_t seed = 1) {
  Rng rng(seed);
  std::vector<float> samples(num_samples);
  float gain = 0.0f;
  for (std::size_t i = 0; i < num_samples; ++i) {
    if (i % 1000 == 0) gain = rng.chance(0.3) ? 0.0f : static_cast<float>(rng.uniform(0.01, 0.5));
    samples[i] = gain * static_cast<float>(rng.uniform(-1.0, 1.0));
  }
  return samples;
}

}  // namespace mien
