#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "mien/base/random.h"
#include "mien/corpus/performance.h"
#include "mien/corpus/speaker.h"
#include "mien/motion/blink.h"

namespace mien {

// Movements that the sound hardly decides: gaze, brows, head, blinks (specification, section 7). Each takes
// its own generator, so that one process does not disturb another. All tracks are at 60 fps.

/// The eyes turn.
struct GazeShift {
  double end_s;  ///< the eyes have arrived
  double deg;    ///< how far they went
};

/// Direction of both eyes, degrees; + = subject's left, up. Zero is eye contact.
struct GazeTrack {
  std::vector<float> x_deg, y_deg;  // [N]
  std::vector<GazeShift> shifts;    ///< between eye contact and away, in time order; no fixational jumps
};
GazeTrack draw_gaze(const Speaker& speaker, std::int64_t num_frames, Rng& rng);

/// A raise of the brows.
struct BrowGesture {
  double centre_s;   ///< middle of its hold
  double amplitude;  ///< coefficient of browInnerUp
};

/// Brow raises at accents and at the end of a question, and a slow drift around zero; coefficients.
struct BrowTrack {
  std::vector<float> raise, drift;  // [N]; raise is the sum of all raises
  std::vector<BrowGesture> raises;  ///< the same as events: accents in order, then the question
};
BrowTrack draw_brows(const Speaker& speaker, const Utterance& utterance, std::int64_t num_frames, Rng& rng);

/// Head angles in degrees, in the order of head_names().
struct HeadTrack {
  std::vector<float> yaw_deg, pitch_deg, roll_deg;  // [N]
};
HeadTrack draw_head(const Speaker& speaker, const Utterance& utterance, const GazeTrack& gaze, Rng& rng);

/// What decides when to blink.
struct BlinkContext {
  double blinks_per_minute = 18;  ///< primary blinks, with the emotion's factor
  double seconds = 0;
  std::vector<TimeSpan> pauses = {};   ///< blinks move there
  std::vector<GazeShift> shifts = {};  ///< large ones are followed by a blink
};
/// Blinks with onsets in [0, seconds), in time order, at least 0.25 s apart.
std::vector<BlinkEvent> draw_blinks(const BlinkContext& context, Rng& rng);

/// Speech activity: 1 in phones, 0 in pauses, smoothed with a 0.5 s Hann window. [num_frames]
std::vector<float> speech_activity(const Utterance& utterance, std::int64_t num_frames);

}  // namespace mien
