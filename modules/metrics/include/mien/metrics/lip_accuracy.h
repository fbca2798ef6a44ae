#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "mien/core/motion.h"

namespace mien {

/// Lips of a generated performance against the conditional mean of the truth (corpus specification, sections
/// 13 and 15; thresholds of default_model.md, section 9). All motions are performances of one recording.

/// The twelve curves whose correlations are averaged into "r".
inline constexpr std::size_t kNumLipCurves = 12;
std::span<const std::string_view, kNumLipCurves> lip_curve_names();

/// Sums from which Pearson's r over the frames of many recordings follows; pools with +=.
struct CorrelationSums {
  double n = 0, x = 0, y = 0, xx = 0, yy = 0, xy = 0;

  void add(double a, double b) { ++n, x += a, y += b, xx += a * a, yy += b * b, xy += a * b; }
  CorrelationSums& operator+=(const CorrelationSums& other);
  /// NaN when one side does not vary.
  [[nodiscard]] double r() const;
};

/// Runs found and not found; pools with +=.
struct DetectionCounts {
  std::int64_t frames_both = 0, frames_truth = 0, frames_predicted = 0;  ///< frame by frame
  std::int64_t truth_frames_near = 0;      ///< truth frames with a predicted frame within +-2 frames
  std::int64_t predicted_frames_near = 0;  ///< predicted frames with a truth frame within +-2 frames
  std::int64_t events = 0,
               events_hit = 0;  ///< runs of the truth; hit: a predicted frame within +-2 frames of the run
  std::int64_t runs = 0,
               runs_true = 0;  ///< runs of the prediction; true: touch a truth run within +-2 frames

  DetectionCounts& operator+=(const DetectionCounts& other);
  [[nodiscard]] double frame_f1() const;     ///< frame-exact
  [[nodiscard]] double tolerant_f1() const;  ///< frames count when the other side has one within +-2 frames
  [[nodiscard]] double hit_rate() const;
  [[nodiscard]] double precision() const;  ///< of runs
};

/// Rounded lips (mouthPucker): when they begin to round; pools with +=. Events are runs of the truth above
/// 0.25; an onset is where the curve passes half of the run's peak on the way up to it. Found: the prediction
/// peaks above 0.125 within
/// +-100 ms of the run.
struct RoundingScore {
  std::int64_t events = 0, found = 0;
  std::vector<double> onset_errors_ms;  ///< of found events; positive = the prediction is late

  RoundingScore& operator+=(const RoundingScore& other);
  [[nodiscard]] double hit_rate() const;
};
RoundingScore score_rounding(const Motion& truth, const Motion& predicted);

struct LipAccuracy {
  std::array<CorrelationSums, kNumLipCurves> curves;
  CorrelationSums aperture;      ///< of jawOpen - mouthClose
  DetectionCounts closures;      ///< lips pressed
  DetectionCounts labiodentals;  ///< lower lip on the teeth (f, v)
  RoundingScore rounding;
  std::int64_t seal_chances = 0,
               sealed = 0;  ///< closures times takes; where that take has A < 0.04 within +-2 frames
  std::vector<double> timing_errors_ms;  ///< per hit closure: aperture minimum of prediction - of truth

  LipAccuracy& operator+=(const LipAccuracy& other);
  /// Mean over the twelve curves; curves that are constant on one side are left out.
  [[nodiscard]] double mean_r() const;
  [[nodiscard]] double jaw_r() const { return curves[0].r(); }
  [[nodiscard]] double seal() const;
};

/// @param conditional_mean  mean of many true takes of the recording
/// @param samples           generated takes; correlations and detections use their mean, seal each single one
/// @param press_gain        of the style (Speaker::press): thresholds are mean mouthPress > 0.26 gain in the
/// truth and
///                          > 0.165 gain in the prediction. 0 leaves closures and labiodentals out: emotions
///                          press the lips all the time, so they are scored on neutral recordings only.
LipAccuracy score_lips(const Motion& conditional_mean, std::span<const Motion> samples, double press_gain);

}  // namespace mien
