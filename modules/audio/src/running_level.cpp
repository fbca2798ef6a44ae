#include "mien/audio/running_level.h"

#include <algorithm>

#include "mien/base/contract.h"

namespace mien {

float frame_level(std::span<const float, kNumMelBands> log_mel_frame) {
  float sum = 0.0f;
  for (const float x : log_mel_frame) sum += x;
  return sum / kNumMelBands;
}

RunningLevel::RunningLevel() {
  recent_.reserve(kLevelWindow);
  sorted_.reserve(kLevelWindow + 1);
}

float RunningLevel::push(std::span<const float, kNumMelBands> log_mel_frame) {
  const float level = frame_level(log_mel_frame);
  // One NaN would break the order of sorted_ for good.
  contract(std::isfinite(level), "RunningLevel::push: a frame is not finite");
  if (recent_.size() < kLevelWindow) {
    recent_.push_back(level);
  } else {
    sorted_.erase(std::lower_bound(sorted_.begin(), sorted_.end(), recent_[next_]));
    recent_[next_] = level;
    next_ = (next_ + 1) % kLevelWindow;
  }
  sorted_.insert(std::upper_bound(sorted_.begin(), sorted_.end(), level), level);
  const double position = 0.95 * static_cast<double>(sorted_.size() - 1);
  const auto below = static_cast<std::size_t>(position);
  const std::size_t above = std::min(below + 1, sorted_.size() - 1);
  const double fraction = position - static_cast<double>(below);
  const double percentile = (1.0 - fraction) * sorted_[below] + fraction * sorted_[above];
  return std::max(static_cast<float>(percentile), kLevelFloor);
}

std::vector<float> running_levels(const Features& log_mel) {
  contract(log_mel.width == kNumMelBands, "running_levels: not a log-mel");
  RunningLevel running;
  std::vector<float> levels;
  levels.reserve(static_cast<std::size_t>(log_mel.num_frames()));
  for (std::int64_t t = 0; t < log_mel.num_frames(); ++t)
    levels.push_back(running.push(log_mel.frame(t).first<kNumMelBands>()));
  return levels;
}

void normalise_mel(std::span<const float, kNumMelBands> log_mel_frame, float level,
                   std::span<float, kNumMelBands> out) {
  for (int b = 0; b < kNumMelBands; ++b) out[b] = normalise_mel(log_mel_frame[b], level);
}

}  // namespace mien
