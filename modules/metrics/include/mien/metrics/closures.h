#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "mien/metrics/aperture.h"
#include "mien/metrics/speech_labels.h"

namespace mien {

/// What counts as closed for one recording: R = 90th percentile of A over frames inside phones (not sil, not
/// sp), at least 0.05 (mesh: 1 mm); closed means A <= theta = 0.15 R (mesh: max(0.15 R, 0.5 mm)).
struct OpeningScale {
  double r = 0;
  double theta = 0;
};
OpeningScale opening_scale(const Aperture& aperture, const SpeechLabels& labels);

/// Frames first ... last, both inside.
struct FrameRun {
  std::int64_t first = 0, last = 0;
};
/// Maximal runs of frames with value <= theta; runs with at most one open frame between them are one run.
std::vector<FrameRun> closed_runs(std::span<const double> aperture, double theta);

/// One lip closure to find: a bilabial, or a merged group of them.
struct ClosureEvent {
  ClosureWindow window;
  bool doubtful = false;  ///< not a target
  bool timed = false;     ///< its centre can be heard: no edge, cluster or merged flag
};
/// All events of a recording; rows flagged same_event_as_previous add none.
std::vector<ClosureEvent> closure_events(const SpeechLabels& labels);

/// Counts and lists of one or more recordings; sum them with +=, form ratios last.
struct ClosureScore {
  std::int64_t targets = 0;
  std::int64_t hits = 0;
  std::int64_t sealed = 0;  ///< hits with min A <= 0 in the window: the lips of a single take really touch
  std::int64_t true_positives = 0;
  std::int64_t false_positives = 0;
  std::vector<double> timing_errors_ms;  ///< of timed hits; positive = the face is late
  std::vector<double> depths;            ///< per hit: min A / R in the window

  ClosureScore& operator+=(const ClosureScore& other);

  // Ratios; NaN when the denominator is zero, F1 is 0 when nothing was hit.
  [[nodiscard]] double hit_rate() const;
  [[nodiscard]] double precision() const;
  [[nodiscard]] double f1() const;
  [[nodiscard]] double sealed_share() const;
  [[nodiscard]] double timing_bias_ms() const;  ///< median
  [[nodiscard]] double timing_mad_ms() const;   ///< median absolute deviation
  [[nodiscard]] double depth() const;           ///< median
};

/// Scores the lip closures of one recording as the human benchmark's README defines ("Measurements",
/// "Events"), to the letter. Window ends are inclusive and compared in double precision as written there:
/// frames at n / 60, window [closure_start - tolerance, closure_end + tolerance]; a run's length is the time
/// from its first to its last frame. Frames past the end of the labels count as its last phone.
///
/// @param tolerance_s  0.050 for the main figure, 0.020 for the strict one
ClosureScore score_closures(const Aperture& aperture, const SpeechLabels& labels, double tolerance_s);

inline constexpr double kClosureToleranceSeconds = 0.050;
inline constexpr double kStrictClosureToleranceSeconds = 0.020;

}  // namespace mien
