#include "mien/motion/brow_raise.h"

#include <algorithm>

#include "mien/base/contract.h"
#include "mien/core/arkit.h"
#include "smooth_step.h"

namespace mien {
namespace {

constexpr float kOuterGain = 0.72f;

void raise(float& coefficient, float r) { coefficient += r * (1 - coefficient); }

}  // namespace

double brow_raise_shape(const BrowRaise& raise, double t) {
  if (t <= 0 || t >= raise.seconds()) return 0;
  if (t < raise.rise_s) return smooth_step(t / raise.rise_s);
  return 1 - smooth_step((t - raise.rise_s) / raise.fall_s);
}

float brow_height(std::span<const BrowRaise> raises, double t_s) {
  double height = 0;
  for (const BrowRaise& r : raises) height += r.amplitude * brow_raise_shape(r, t_s - r.onset_s);
  return static_cast<float>(std::clamp(height, 0.0, 1.0));
}

BrowRaise draw_brow_raise(Rng& rng) {
  BrowRaise r;
  r.rise_s = 1e-3 * std::clamp(rng.normal(105, 10), 90.0, 120.0);
  r.fall_s = 1e-3 * std::clamp(rng.normal(350, 80), 200.0, 600.0);
  return r;
}

void apply_brow_raise(std::span<float> coefficients, float height) {
  contract(coefficients.size() >= kNumArkit,
           "apply_brow_raise: a frame must start with the 52 ARKit coefficients");
  static const std::size_t inner = arkit_index("browInnerUp"), left = arkit_index("browOuterUpLeft"),
                           right = arkit_index("browOuterUpRight");
  if (height <= 0) return;
  raise(coefficients[inner], height);
  raise(coefficients[left], kOuterGain * height);
  raise(coefficients[right], kOuterGain * height);
}

}  // namespace mien
