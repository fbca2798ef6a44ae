#pragma once
#include <span>

#include "mien/base/random.h"

namespace mien {

/// One raise of the brows, placed by its onset, so that a raise that is decided at an instant changes nothing
/// before it. Times in seconds.
struct BrowRaise {
  double onset_s = 0;    ///< instant at which the brows start to rise
  double rise_s = 0;     ///< from rest to the top
  double fall_s = 0;     ///< from the top to rest
  double amplitude = 0;  ///< of browInnerUp, 0 ... 1

  /// Duration of the movement.
  [[nodiscard]] double seconds() const { return rise_s + fall_s; }
};

/// Shape of a raise of amplitude 1, `t` seconds after its onset: S(u) up, 1 - S(u) down, with S(u) = u^2 (3 -
/// 2u); 0 outside of [0, seconds()].
double brow_raise_shape(const BrowRaise& raise, double t);

/// Height of the brows at time `t_s`: the sum of all raises, at most 1. `raises` need not be sorted.
float brow_height(std::span<const BrowRaise> raises, double t_s);

/// A raise with random shape: rise N(105, 10) ms in [90, 120], fall N(350, 80) ms in [200, 600]. Raises of
/// the corpus fall alike, but rise in 180 ms and stay at the top for 80 ms (its specification, section 7):
/// they begin well before their accent. A raise that waits for its accent to be heard must hurry. Onset and
/// amplitude are left at zero. Always draws the same number of random values.
BrowRaise draw_brow_raise(Rng& rng);

/// Adds the brows' height to the ARKit coefficients of one frame: w += r (1 - w) with r = height for
/// browInnerUp and 0.72 height for browOuterUpLeft and browOuterUpRight.
/// @param coefficients  at least the 52 ARKit coefficients in the order of arkit_names(); what follows is not
/// touched
void apply_brow_raise(std::span<float> coefficients, float height);

}  // namespace mien
