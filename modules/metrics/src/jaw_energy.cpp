#include "mien/metrics/jaw_energy.h"

#include <algorithm>
#include <cmath>

#include "mien/metrics/aperture.h"
#include "mien/metrics/loudness.h"
#include "mien/metrics/statistics.h"
#include "undefined.h"

namespace mien {
namespace {

constexpr double kNearPhoneSeconds = 0.100;

// Frames inside phones and within 100 ms of one.
std::vector<bool> frames_near_phones(const SpeechLabels& labels, std::size_t num_frames) {
  std::vector<bool> near(num_frames, false);
  for (const PhoneRow& row : labels.rows) {
    if (row.is_silence()) continue;
    for (std::size_t n = 0; n < num_frames; ++n) {
      const double t = static_cast<double>(n) / kMetricFps;
      if (t >= row.start - kNearPhoneSeconds && t <= row.end + kNearPhoneSeconds) near[n] = true;
    }
  }
  return near;
}

}  // namespace

JawEnergy jaw_energy(std::span<const double> jaw, std::span<const double> level_db,
                     const SpeechLabels& labels) {
  const std::size_t count = std::min(jaw.size(), level_db.size());
  const std::vector<double> smooth_jaw = smooth_30_ms(jaw);
  const std::vector<bool> scored = frames_near_phones(labels, count);
  JawEnergy out;
  for (int lag = -kMaxJawLagFrames; lag <= kMaxJawLagFrames; ++lag) {
    std::vector<double> x, y;
    for (std::size_t n = 0; n < count; ++n) {
      const std::int64_t late = static_cast<std::int64_t>(n) + lag;
      if (!scored[n] || late < 0 || late >= static_cast<std::int64_t>(count)) continue;
      x.push_back(level_db[n]);
      y.push_back(smooth_jaw[static_cast<std::size_t>(late)]);
    }
    out.r_at_lag[static_cast<std::size_t>(lag + kMaxJawLagFrames)] = pearson(x, y);
    if (lag == 0) out.frames = static_cast<std::int64_t>(x.size());
  }
  return out;
}

PooledJawEnergy pool_jaw_energy(std::span<const JawEnergy> clips) {
  PooledJawEnergy out{kNan, kNan};
  double best = -2;
  for (int lag = -kMaxJawLagFrames; lag <= kMaxJawLagFrames; ++lag) {
    std::vector<double> r, weights;
    for (const JawEnergy& clip : clips) {
      r.push_back(clip.r_at_lag[static_cast<std::size_t>(lag + kMaxJawLagFrames)]);
      weights.push_back(static_cast<double>(clip.frames));
    }
    const double pooled = fisher_mean(r, weights);
    if (lag == 0) out.r = pooled;
    if (pooled > best) best = pooled, out.lag_ms = lag * 1000.0 / kMetricFps;
  }
  return out;
}

}  // namespace mien
