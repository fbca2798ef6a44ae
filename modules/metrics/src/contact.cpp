#include "mien/metrics/contact.h"

#include <algorithm>
#include <cmath>

#include "mien/base/contract.h"
#include "mien/core/arkit.h"
#include "mien/metrics/statistics.h"
#include "undefined.h"

namespace mien {
namespace {

constexpr double kMinPauseConfidence = 0.7;
constexpr double kSettleSeconds = 0.150;   // the mouth may still close
constexpr double kPrepareSeconds = 0.100;  // and open for what comes
constexpr std::size_t kFirstMouthCurve = 14, kLastMouthCurve = 40;

// The 27 jaw and mouth curves of a motion, [27][N]; absent ones are zero.
std::vector<std::vector<double>> mouth_curves(const Motion& motion) {
  std::vector<std::vector<double>> out;
  for (std::size_t c = kFirstMouthCurve; c <= kLastMouthCurve; ++c) {
    auto series = channel_series(motion, arkit_names()[c]);
    out.push_back(series ? std::move(series).value()
                         : std::vector<double>(static_cast<std::size_t>(motion.num_frames()), 0.0));
  }
  return out;
}

double speed(std::span<const double> series, std::size_t n) {
  return std::abs(series[n] - series[n - 1]) * kMetricFps;
}

}  // namespace

RestScore& RestScore::operator+=(const RestScore& other) {
  pause_speed += other.pause_speed;
  phone_speed += other.phone_speed;
  mouth_pause_speed += other.mouth_pause_speed;
  mouth_phone_speed += other.mouth_phone_speed;
  curve_pause_speed += other.curve_pause_speed;
  curve_phone_speed += other.curve_phone_speed;
  pause_aperture += other.pause_aperture;
  takes += other.takes;
  closed_at_end += other.closed_at_end;
  return *this;
}

double RestScore::closed_at_end_share() const {
  return takes > 0 ? static_cast<double>(closed_at_end) / static_cast<double>(takes) : kNan;
}

std::vector<bool> pause_frames(const SpeechLabels& labels, std::int64_t num_frames) {
  std::vector<bool> out(static_cast<std::size_t>(std::max<std::int64_t>(0, num_frames)), false);
  for (const PhoneRow& row : labels.rows) {
    if (row.phone != "sil" || row.confidence < kMinPauseConfidence || (row.flags & kNotQuiet) != 0) continue;
    for (std::size_t n = 0; n < out.size(); ++n) {
      const double t = static_cast<double>(n) / kMetricFps;
      if (t >= row.start + kSettleSeconds && t <= row.end - kPrepareSeconds) out[n] = true;
    }
  }
  return out;
}

RestScore score_rest(const Aperture& aperture, const SpeechLabels& labels, const Motion* mouth) {
  const std::vector<double>& a = aperture.values;
  contract(mouth == nullptr || mouth->num_frames() >= static_cast<std::int64_t>(a.size()),
           "score_rest: the motion is shorter than its aperture");
  RestScore score;
  const auto rows = labels.rows_of_frames(static_cast<std::int64_t>(a.size()), kMetricFps);
  if (rows.empty()) return score;
  const auto pauses = pause_frames(labels, static_cast<std::int64_t>(a.size()));
  const OpeningScale scale = opening_scale(aperture, labels);
  score.takes = 1;
  score.closed_at_end = a.back() <= scale.theta;

  std::vector<std::vector<double>> curves;
  std::vector<double> average;
  if (mouth != nullptr) {
    curves = mouth_curves(*mouth);
    average.assign(a.size(), 0.0);
    for (const auto& curve : curves)
      for (std::size_t n = 0; n < a.size(); ++n) average[n] += curve[n] / static_cast<double>(curves.size());
  }
  for (std::size_t n = 0; n < a.size(); ++n) {
    const bool phone = !labels.rows[rows[n]].is_silence();
    if (pauses[n]) score.pause_aperture.add(a[n] / scale.r);
    if (n == 0 || !(pauses[n] || phone)) continue;
    (pauses[n] ? score.pause_speed : score.phone_speed).add(speed(a, n));
    if (mouth == nullptr) continue;
    (pauses[n] ? score.mouth_pause_speed : score.mouth_phone_speed).add(speed(average, n));
    double sum = 0;
    for (const auto& curve : curves) sum += speed(curve, n);
    (pauses[n] ? score.curve_pause_speed : score.curve_phone_speed)
        .add(sum / static_cast<double>(curves.size()));
  }
  return score;
}

StillnessScore score_stillness(const Aperture& aperture) {
  const std::vector<double>& a = aperture.values;
  StillnessScore score;
  if (a.empty()) return score;
  score.mean_aperture = mean(a);
  score.largest_aperture = *std::max_element(a.begin(), a.end());
  score.last_aperture = a.back();
  for (std::size_t n = 1; n < a.size(); ++n)
    score.mean_speed += speed(a, n) / static_cast<double>(a.size() - 1);
  return score;
}

}  // namespace mien
