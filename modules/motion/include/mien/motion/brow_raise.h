#pragma once
#include <span>

#include "mien/base/random.h"

namespace mien {

/// One raise of the brows: a bump of the shape that the corpus specification, section 7, gives to raises at
/// accents, placed by its onset, so that a raise that is decided at an instant changes nothing before it.
/// Times in seconds.
struct BrowRaise {
  double onset_s = 0;    ///< instant at which the brows start to rise
  double rise_s = 0;     ///< from rest to the top
  double hold_s = 0;     ///< at the top
  double fall_s = 0;     ///< from the top to rest
  double amplitude = 0;  ///< of browInnerUp, 0 ... 1

  /// Duration of the movement.
  [[nodiscard]] double seconds() const { return rise_s + hold_s + fall_s; }
};

/// Shape of a raise of amplitude 1, `t` seconds after its onset: S(u) up, 1 while held, 1 - S(u) down, with
/// S(u) = u^2 (3 - 2u); 0 outside of [0, seconds()].
double brow_raise_shape(const BrowRaise& raise, double t);

/// Height of the brows at time `t_s`: the sum of all raises, at most 1. `raises` need not be sorted.
float brow_height(std::span<const BrowRaise> raises, double t_s);

/// A raise with random shape: rise N(120, 15) ms in [100, 140], hold 80 ms, fall N(350, 80) ms in [200, 600].
/// Hold and fall are those of the corpus. The rise is faster than the corpus' 180 ms, because a raise that
/// waits for its accent to be heard has less time to reach its top near it. Onset and amplitude are left at
/// zero. Always draws the same number of random values.
BrowRaise draw_brow_raise(Rng& rng);

/// Adds the brows' height to the ARKit coefficients of one frame: w += r (1 - w) with r = height for
/// browInnerUp and 0.72 height for browOuterUpLeft and browOuterUpRight.
/// @param coefficients  at least the 52 ARKit coefficients in the order of arkit_names(); what follows is not
/// touched
void apply_brow_raise(std::span<float> coefficients, float height);

}  // namespace mien
