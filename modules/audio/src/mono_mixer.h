#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sound_source.h"

namespace mien {

/// Mean of the channels, with a check of every sample on the way.
class MonoMixer {
 public:
  explicit MonoMixer(int sample_rate_hz) : sample_rate_hz_(sample_rate_hz) {}

  /// mono: [n], replaced. Returns what is wrong with the first bad sample (NaN, infinite, absurdly large), if
  /// any.
  std::optional<std::string> mix(const SoundBlock& block, std::vector<float>& mono);
  /// What is odd about the sound as a whole: silent, cancelled by its channels, clipped.
  [[nodiscard]] std::vector<std::string> verdict() const;

 private:
  int sample_rate_hz_;
  std::int64_t num_frames_ = 0;
  std::int64_t num_samples_ = 0;   // of all channels
  std::int64_t num_at_limit_ = 0;  // at full scale
  double mono_energy_ = 0;         // sum of squares of the mean
  double channel_energy_ = 0;      // mean over channels of the sums of squares
};

}  // namespace mien
