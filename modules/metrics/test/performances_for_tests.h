#pragma once
#include <cstdint>
#include <functional>
#include <string_view>
#include <vector>

#include "mien/base/random.h"
#include "mien/core/arkit.h"
#include "mien/core/motion.h"

namespace mien::test {

// A performance of zeros.
inline Motion still(std::int64_t num_frames) {
  return {MotionSpace::arkit, arkit_and_head_channels(), 60,
          std::vector<float>(static_cast<std::size_t>(num_frames) * 55, 0.f)};
}

inline std::size_t channel(std::string_view name) {
  const auto names = arkit_and_head_channels();
  std::size_t c = 0;
  while (names[c] != name) ++c;
  return c;
}

// Sets channels to value(n).
inline void set(Motion& motion, const std::vector<std::string_view>& channels,
                const std::function<double(std::int64_t)>& value) {
  for (const std::string_view name : channels)
    for (std::int64_t n = 0; n < motion.num_frames(); ++n)
      motion.frame(n)[channel(name)] = static_cast<float>(value(n));
}

// Independent normal noise in every channel and frame.
inline Motion noise(std::int64_t num_frames, double sd, std::uint64_t seed) {
  Motion motion = still(num_frames);
  Rng rng(seed);
  for (float& v : motion.values) v = static_cast<float>(rng.normal(0, sd));
  return motion;
}

}  // namespace mien::test
