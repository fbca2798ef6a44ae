#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "mien/core/motion.h"

namespace mien {

/// Events of the upper face, found in truth and prediction with the same detectors (corpus specification,
/// section 13). All take performances (require_performance).

/// A stretch of time, seconds.
struct TimeInterval {
  double start = 0, end = 0;
};

/// One blink: the mean of both lids rises through 0.5.
struct DetectedBlink {
  double time = 0;     ///< of the crossing, seconds
  double onset = 0;    ///< where that rise began, seconds
  double closing = 0;  ///< from 10 % to 90 % of the way from the onset's level to the peak, seconds
  double opening = 0;  ///< from 90 % back to 10 %, seconds
};
std::vector<DetectedBlink> detect_blinks(const Motion& motion);

/// Blinks of one or more takes; pools with +=.
struct BlinkScore {
  double seconds = 0;
  std::int64_t blinks = 0;
  std::int64_t in_pauses = 0;       ///< whose onset lies in a pause
  std::vector<double> intervals_s;  ///< between successive blinks of a take
  std::vector<double> closings_s, openings_s;

  BlinkScore& operator+=(const BlinkScore& other);
  [[nodiscard]] double per_minute() const;
  [[nodiscard]] double share_in_pauses() const;
};
BlinkScore score_blinks(const Motion& motion, std::span<const TimeInterval> pauses);

/// Instants at which browInnerUp peaks after a rise of at least 0.06 within 0.4 s; the largest within +-0.15
/// s.
std::vector<double> detect_brow_raises(const Motion& motion);
/// Instants at which headPitch is lowest after a fall of at least 1 degree within 0.3 s; the lowest within
/// +-0.15 s.
std::vector<double> detect_nods(const Motion& motion);

/// Whether gestures keep to accents; pools with +=.
struct AccentScore {
  std::int64_t accents = 0, accents_met = 0;    ///< met: an event within +-150 ms
  std::int64_t instants = 0, instants_met = 0;  ///< the same at every frame: the chance level

  AccentScore& operator+=(const AccentScore& other);
  [[nodiscard]] double rate() const;  ///< P(event at an accent)
  /// P(event at an accent) / P(event at a random time): 1 = no relation. NaN without events.
  [[nodiscard]] double lift() const;
};
AccentScore score_accents(std::span<const double> event_times, std::span<const double> accents,
                          std::int64_t num_frames);

/// Where the eyes rest; pools with +=. Contact = gaze less than 3 degrees off the viewer (33 degrees
/// horizontally, 28 vertically at coefficient 1, both eyes averaged); stretches cut by the clip's ends are
/// left out.
struct GazeScore {
  std::vector<double> contact_s, away_s;  ///< durations
  std::int64_t frames = 0, away_frames = 0;

  GazeScore& operator+=(const GazeScore& other);
  [[nodiscard]] double share_away() const;
};
GazeScore score_gaze(const Motion& motion);

}  // namespace mien
