#include "mien/metrics/loudness.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mien/core/audio_clip.h"
#include "mien/core/motion.h"
#include "mien/metrics/aperture.h"
#include "mien/metrics/statistics.h"

namespace mien {
namespace {

constexpr std::int64_t kWindowSamples = 400;  // 25 ms
constexpr double kPowerFloor = 1e-7;
constexpr double kLoudPercentile = 95;
constexpr double kFloorBelowLoudDb = 35;
constexpr double kLoudnessRangeDb = 30;
constexpr double kSmoothSeconds = 0.030;
constexpr int kSmoothRadius = 6;

}  // namespace

std::vector<double> smooth_30_ms(std::span<const double> values) {
  return smooth_gaussian(values, kSmoothSeconds * kMetricFps, kSmoothRadius);
}

std::vector<double> speech_level_db(std::span<const float> samples_16k) {
  std::vector<double> window(kWindowSamples);
  double window_sum = 0;
  for (std::size_t i = 0; i < window.size(); ++i) {
    window[i] = 0.5 - 0.5 * std::cos(2 * std::numbers::pi * static_cast<double>(i) / kWindowSamples);
    window_sum += window[i];
  }
  const auto num_samples = static_cast<std::int64_t>(samples_16k.size());
  const std::int64_t num_frames =
      num_motion_frames(static_cast<double>(num_samples) / kModelSampleRateHz, kMetricFps);
  std::vector<double> level(static_cast<std::size_t>(num_frames));
  for (std::int64_t n = 0; n < num_frames; ++n) {
    const std::int64_t first =
        std::llround(static_cast<double>(n) * kModelSampleRateHz / kMetricFps) - kWindowSamples / 2;
    const std::int64_t from = std::max<std::int64_t>(0, -first);
    const std::int64_t to = std::min(kWindowSamples, num_samples - first);
    double power = 0;
    for (std::int64_t i = from; i < to; ++i) {
      const double x = samples_16k[static_cast<std::size_t>(first + i)];
      power += window[static_cast<std::size_t>(i)] * x * x;
    }
    level[static_cast<std::size_t>(n)] = 10 * std::log10(power / window_sum + kPowerFloor);
  }
  if (level.empty()) return level;
  const double floor = percentile(level, kLoudPercentile) - kFloorBelowLoudDb;
  for (double& l : level) l = std::max(l, floor);
  return smooth_30_ms(level);
}

std::vector<double> loudness(std::span<const double> level_db) {
  std::vector<double> out(level_db.begin(), level_db.end());
  const double loud = percentile(out, kLoudPercentile);
  for (double& e : out) e = std::clamp((e - loud + kLoudnessRangeDb) / kLoudnessRangeDb, 0.0, 1.0);
  return out;
}

}  // namespace mien
