#include "mien/metrics/lip_accuracy.h"

#include <algorithm>
#include <cmath>

#include "mien/base/contract.h"
#include "mien/core/arkit.h"
#include "mien/metrics/aperture.h"
#include "mien/metrics/closures.h"
#include "mien/metrics/regions.h"
#include "undefined.h"

namespace mien {
namespace {

constexpr double kTruthPress = 0.26, kPredictedPress = 0.165;
constexpr double kTruthRoll = 0.40, kPredictedRoll = 0.20;
constexpr double kSealAperture = 0.04;
constexpr std::int64_t kToleranceFrames = 2;
constexpr double kTruthPucker = 0.25, kPredictedPucker = 0.125;
constexpr std::int64_t kRoundingFrames = 6;  // 100 ms: rounding is slower than closing

using Mask = std::vector<bool>;

double harmonic(double precision, double recall) {
  if (std::isnan(recall)) return recall;
  return precision > 0 && recall > 0 ? 2 * precision * recall / (precision + recall) : 0;
}

Mask above(const std::vector<double>& values, double threshold) {
  Mask out(values.size());
  for (std::size_t n = 0; n < values.size(); ++n) out[n] = values[n] > threshold;
  return out;
}

std::vector<FrameRun> runs_of(const Mask& mask) {
  std::vector<FrameRun> runs;
  for (std::int64_t n = 0; n < static_cast<std::int64_t>(mask.size()); ++n) {
    if (!mask[static_cast<std::size_t>(n)]) continue;
    if (!runs.empty() && runs.back().last == n - 1)
      runs.back().last = n;
    else
      runs.push_back({n, n});
  }
  return runs;
}

// Frames of a run widened by the tolerance, cut to the recording.
FrameRun widened(FrameRun run, std::size_t num_frames) {
  return {std::max<std::int64_t>(0, run.first - kToleranceFrames),
          std::min(static_cast<std::int64_t>(num_frames) - 1, run.last + kToleranceFrames)};
}

bool any_within(const Mask& mask, FrameRun run) {
  const FrameRun wide = widened(run, mask.size());
  for (std::int64_t n = wide.first; n <= wide.last; ++n)
    if (mask[static_cast<std::size_t>(n)]) return true;
  return false;
}

DetectionCounts detect(const Mask& truth, const Mask& predicted) {
  DetectionCounts out;
  for (std::size_t n = 0; n < truth.size(); ++n) {
    const auto frame = static_cast<std::int64_t>(n);
    out.frames_truth += truth[n];
    out.frames_predicted += predicted[n];
    out.frames_both += truth[n] && predicted[n];
    out.truth_frames_near += truth[n] && any_within(predicted, {frame, frame});
    out.predicted_frames_near += predicted[n] && any_within(truth, {frame, frame});
  }
  for (const FrameRun& run : runs_of(truth)) ++out.events, out.events_hit += any_within(predicted, run);
  for (const FrameRun& run : runs_of(predicted)) ++out.runs, out.runs_true += any_within(truth, run);
  return out;
}

std::vector<double> mean_of_sides(const Motion& motion, std::string_view left, std::string_view right) {
  std::vector<double> out = channel_values(motion, arkit_index(left));
  const std::vector<double> other = channel_values(motion, arkit_index(right));
  for (std::size_t n = 0; n < out.size(); ++n) out[n] = (out[n] + other[n]) / 2;
  return out;
}

std::vector<double> press(const Motion& motion) {
  return mean_of_sides(motion, "mouthPressLeft", "mouthPressRight");
}

std::vector<double> opening(const Motion& motion) {
  return curve_aperture(motion, ApertureVariant::curves).value().values;  // a performance has both curves
}

std::int64_t lowest_frame(const std::vector<double>& aperture, FrameRun run) {
  const FrameRun wide = widened(run, aperture.size());
  return std::min_element(aperture.begin() + wide.first, aperture.begin() + wide.last + 1) - aperture.begin();
}

// Frame with the largest value among first ... last, both inside.
std::int64_t highest_frame(const std::vector<double>& values, FrameRun run) {
  return std::max_element(values.begin() + run.first, values.begin() + run.last + 1) - values.begin();
}

// Instant in frames at which the curve passes half of its value at `peak` on the way up; zero when it starts
// above.
double half_height(const std::vector<double>& values, std::int64_t peak) {
  const double half = values[static_cast<std::size_t>(peak)] / 2;
  for (std::int64_t n = peak; n > 0; --n) {
    const double before = values[static_cast<std::size_t>(n - 1)], at = values[static_cast<std::size_t>(n)];
    if (before <= half) return static_cast<double>(n - 1) + (half - before) / std::max(at - before, 1e-12);
  }
  return 0;
}

void score_contacts(const Motion& truth, const Motion& predicted, std::span<const Motion> samples,
                    double gain, LipAccuracy& out) {
  const Mask truth_pressed = above(press(truth), kTruthPress * gain);
  const Mask predicted_pressed = above(press(predicted), kPredictedPress * gain);
  out.closures = detect(truth_pressed, predicted_pressed);
  const std::size_t roll = arkit_index("mouthRollLower");
  out.rounding = score_rounding(truth, predicted);
  out.labiodentals = detect(above(channel_values(truth, roll), kTruthRoll),
                            above(channel_values(predicted, roll), kPredictedRoll));

  const std::vector<FrameRun> closures = runs_of(truth_pressed);
  for (const Motion& sample : samples) {
    const std::vector<double> aperture = opening(sample);
    for (const FrameRun& run : closures) {
      ++out.seal_chances;
      out.sealed += aperture[static_cast<std::size_t>(lowest_frame(aperture, run))] < kSealAperture;
    }
  }
  const std::vector<double> true_aperture = opening(truth), predicted_aperture = opening(predicted);
  for (const FrameRun& run : closures) {
    if (!any_within(predicted_pressed, run)) continue;
    const std::int64_t late = lowest_frame(predicted_aperture, run) - lowest_frame(true_aperture, run);
    out.timing_errors_ms.push_back(1000.0 * static_cast<double>(late) / kMetricFps);
  }
}

}  // namespace

std::span<const std::string_view, kNumLipCurves> lip_curve_names() {
  static constexpr std::string_view kNames[kNumLipCurves] = {
      "jawOpen",          "mouthClose",     "mouthFunnel",    "mouthPucker",        "mouthSmileLeft",
      "mouthStretchLeft", "mouthRollLower", "mouthPressLeft", "mouthLowerDownLeft", "mouthUpperUpLeft",
      "jawForward",       "tongueOut"};
  return kNames;
}

CorrelationSums& CorrelationSums::operator+=(const CorrelationSums& other) {
  n += other.n;
  x += other.x, y += other.y;
  xx += other.xx, yy += other.yy, xy += other.xy;
  return *this;
}

double CorrelationSums::r() const {
  constexpr double kNoVariance = 1e-12;  // of curves in 0 ... 1: rounding leaves about 1e-17
  const double var_x = xx / n - x * x / (n * n), var_y = yy / n - y * y / (n * n);
  if (!(n > 1) || !(var_x > kNoVariance) || !(var_y > kNoVariance)) return kNan;
  return std::clamp((xy / n - x * y / (n * n)) / std::sqrt(var_x * var_y), -1.0, 1.0);
}

DetectionCounts& DetectionCounts::operator+=(const DetectionCounts& other) {
  frames_both += other.frames_both;
  frames_truth += other.frames_truth;
  frames_predicted += other.frames_predicted;
  truth_frames_near += other.truth_frames_near;
  predicted_frames_near += other.predicted_frames_near;
  events += other.events;
  events_hit += other.events_hit;
  runs += other.runs;
  runs_true += other.runs_true;
  return *this;
}

double DetectionCounts::frame_f1() const {
  return harmonic(ratio(frames_both, frames_predicted), ratio(frames_both, frames_truth));
}
double DetectionCounts::tolerant_f1() const {
  return harmonic(ratio(predicted_frames_near, frames_predicted), ratio(truth_frames_near, frames_truth));
}
double DetectionCounts::hit_rate() const { return ratio(events_hit, events); }
double DetectionCounts::precision() const { return ratio(runs_true, runs); }

RoundingScore& RoundingScore::operator+=(const RoundingScore& other) {
  events += other.events;
  found += other.found;
  onset_errors_ms.insert(onset_errors_ms.end(), other.onset_errors_ms.begin(), other.onset_errors_ms.end());
  return *this;
}

double RoundingScore::hit_rate() const { return ratio(found, events); }

RoundingScore score_rounding(const Motion& truth, const Motion& predicted) {
  contract(truth.num_frames() == predicted.num_frames(), "score_rounding: the motions differ in length");
  const std::size_t pucker = arkit_index("mouthPucker");
  const std::vector<double> true_curve = channel_values(truth, pucker),
                            curve = channel_values(predicted, pucker);
  RoundingScore out;
  for (const FrameRun& run : runs_of(above(true_curve, kTruthPucker))) {
    ++out.events;
    const FrameRun wide = {std::max<std::int64_t>(0, run.first - kRoundingFrames),
                           std::min(truth.num_frames() - 1, run.last + kRoundingFrames)};
    const std::int64_t peak = highest_frame(curve, wide);
    if (curve[static_cast<std::size_t>(peak)] <= kPredictedPucker) continue;
    ++out.found;
    const double late = half_height(curve, peak) - half_height(true_curve, highest_frame(true_curve, run));
    out.onset_errors_ms.push_back(1000.0 * late / kMetricFps);
  }
  return out;
}

LipAccuracy& LipAccuracy::operator+=(const LipAccuracy& other) {
  for (std::size_t c = 0; c < curves.size(); ++c) curves[c] += other.curves[c];
  aperture += other.aperture;
  closures += other.closures;
  labiodentals += other.labiodentals;
  rounding += other.rounding;
  seal_chances += other.seal_chances;
  sealed += other.sealed;
  timing_errors_ms.insert(timing_errors_ms.end(), other.timing_errors_ms.begin(),
                          other.timing_errors_ms.end());
  return *this;
}

double LipAccuracy::mean_r() const {
  double sum = 0;
  int count = 0;
  for (const CorrelationSums& curve : curves) {
    const double r = curve.r();
    if (!std::isnan(r)) sum += r, ++count;
  }
  return ratio(sum, count);
}

double LipAccuracy::seal() const { return ratio(sealed, seal_chances); }

LipAccuracy score_lips(const Motion& conditional_mean, std::span<const Motion> samples, double press_gain) {
  require_performance(conditional_mean);
  for (const Motion& sample : samples) require_performance(sample);
  const Motion predicted = mean_motion(samples);
  contract(predicted.values.size() == conditional_mean.values.size(),
           "score_lips: the motions differ in length");
  LipAccuracy out;
  for (std::size_t c = 0; c < kNumLipCurves; ++c) {
    const std::size_t channel = arkit_index(lip_curve_names()[c]);
    for (std::int64_t n = 0; n < predicted.num_frames(); ++n)
      out.curves[c].add(predicted.frame(n)[channel], conditional_mean.frame(n)[channel]);
  }
  const std::vector<double> a = opening(predicted), b = opening(conditional_mean);
  for (std::size_t n = 0; n < a.size(); ++n) out.aperture.add(a[n], b[n]);
  if (press_gain > 0) score_contacts(conditional_mean, predicted, samples, press_gain, out);
  return out;
}

}  // namespace mien
