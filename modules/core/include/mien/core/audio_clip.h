#pragma once
#include <vector>

namespace mien {

/// The rate at which every model of Mien hears.
inline constexpr int kModelSampleRateHz = 16000;

/// Mono sound in memory; full scale is [-1, 1].
struct AudioClip {
  std::vector<float> samples;  // [S]
  int sample_rate_hz = kModelSampleRateHz;

  [[nodiscard]] double seconds() const { return static_cast<double>(samples.size()) / sample_rate_hz; }
};

}  // namespace mien
