#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "mien/base/random.h"
#include "mien/core/motion.h"

namespace mien {

/// One blink: the lids go down fast and up slowly (corpus specification, section 7). The left eye leads by
/// definition; the right eye has a small delay and gain of its own. Times in seconds.
struct BlinkEvent {
  double onset_s = 0;    ///< instant at which the left lid starts to close
  double closing_s = 0;  ///< from open to closed
  double hold_s = 0;     ///< closed
  double opening_s = 0;  ///< from closed to open
  double amplitude = 1;  ///< lid closure reached, 0 ... 1
  double right_delay_s = 0;
  double right_gain = 1;

  /// Duration of the lid movement of one eye.
  [[nodiscard]] double seconds() const { return closing_s + hold_s + opening_s; }
};

/// Closure of the two lids caused by blinks, 0 ... 1.
struct LidClosure {
  float left = 0;
  float right = 0;
};

/// Shape of a blink of amplitude 1, `t` seconds after its onset: S(u) down, 1 while held, (1 - S(u))^0.8 up,
/// with S(u) = u^2 (3 - 2u); 0 outside of [0, seconds()].
double blink_shape(const BlinkEvent& event, double t);

/// Lid closure at time `t_s`: the largest of all events. `events` need not be sorted.
LidClosure lid_closure(std::span<const BlinkEvent> events, double t_s);

/// A blink with random shape: closing N(78, 12) ms in [50, 120], hold N(22, 12) ms in [5, 60], opening N(190,
/// 35) ms in [120, 300]; amplitude U(.92, 1), or with probability 0.15 a partial blink U(.4, .75); right eye
/// delayed by N(0, 3 ms), amplitude times N(1, .02). The onset is left at zero. Always draws the same number
/// of random values.
BlinkEvent draw_blink(Rng& rng);

/// Adds the effect of blinking to the ARKit coefficients of one frame: eyeBlink = max(eyeBlink, b),
/// eyeSquint += 0.12 b (at most 1), eyeWide *= 1 - b, each side with its own b.
/// @param coefficients  at least the 52 ARKit coefficients in the order of arkit_names(); what follows is not
/// touched
void apply_blink(std::span<float> coefficients, LidClosure closure);

/// apply_blink on every frame of a motion with lid_closure(events, n / fps).
/// @pre the first 52 channels are arkit_names(), or the motion is empty
void apply_blinks(Motion& motion, std::span<const BlinkEvent> events);

/// 1 at the frame nearest to each onset, else 0: the training target of the blink model. Onsets outside of
/// the motion are left out.
std::vector<std::uint8_t> blink_onsets(std::span<const BlinkEvent> events, std::int64_t num_frames,
                                       double fps);

}  // namespace mien
