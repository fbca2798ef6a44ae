#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "mien/core/motion.h"
#include "mien/metrics/aperture.h"
#include "mien/metrics/closures.h"
#include "mien/metrics/mean_of.h"
#include "mien/metrics/speech_labels.h"

namespace mien {

/// The contract of contact and silence: lips rest in pauses and the last frame is closed. (That they meet on
/// p, b, m is closures.h.)

/// Motion at rest of one or more recordings (human benchmark README, "Pause motion ratio"); sum with +=.
/// Pauses are rows "sil" with confidence >= 0.7 and not flagged not_quiet, from 150 ms after their start to
/// 100 ms before their end. Speed v(t) = |A(t) - A(t - 1/60)| 60.
struct RestScore {
  MeanOf pause_speed, phone_speed;  ///< of the aperture, per second
  MeanOf mouth_pause_speed,
      mouth_phone_speed;  ///< of the mean over the 27 jaw and mouth curves (entries 14 ... 40)
  MeanOf curve_pause_speed,
      curve_phone_speed;  ///< mean over the same curves of each one's own speed: cannot cancel
  MeanOf pause_aperture;  ///< A / R in pauses
  std::int64_t takes = 0;
  std::int64_t closed_at_end = 0;  ///< takes whose last frame has A <= theta

  RestScore& operator+=(const RestScore& other);
  [[nodiscard]] double pause_motion_ratio() const { return pause_speed.value() / phone_speed.value(); }
  [[nodiscard]] double mouth_pause_motion_ratio() const {
    return mouth_pause_speed.value() / mouth_phone_speed.value();
  }
  [[nodiscard]] double curve_pause_motion_ratio() const {
    return curve_pause_speed.value() / curve_phone_speed.value();
  }
  /// Mean aperture in pauses as a share of R: the mouth left open.
  [[nodiscard]] double mean_pause_aperture() const { return pause_aperture.value(); }
  [[nodiscard]] double closed_at_end_share() const;
};

/// @param mouth  the motion behind the aperture at 60 frames/s, for the 27 curves; curves that it lacks count
/// as not
///               moving. May be null: those fields stay empty.
RestScore score_rest(const Aperture& aperture, const SpeechLabels& labels, const Motion* mouth);

/// Which frames are scored as pause: one flag a frame.
std::vector<bool> pause_frames(const SpeechLabels& labels, std::int64_t num_frames);

/// How still a face is when nothing is said: for recordings of silence or noise, where every frame is a
/// pause.
struct StillnessScore {
  double mean_aperture = 0;  ///< coefficient units
  double largest_aperture = 0;
  double mean_speed = 0;  ///< of the aperture, per second
  double last_aperture = 0;
};
/// Zeros when there are no frames.
StillnessScore score_stillness(const Aperture& aperture);

}  // namespace mien
