#include "mien/motion/blink.h"

#include <algorithm>
#include <cmath>

#include "mien/base/contract.h"
#include "mien/core/arkit.h"
#include "smooth_step.h"

namespace mien {
namespace {

constexpr double kPartialBlinkProbability = 0.15;
constexpr double kSquintOfBlink = 0.12;

// The three coefficients of one eye that a blink moves, as positions in arkit_names().
struct EyeChannels {
  std::size_t blink, squint, wide;
};
constexpr EyeChannels kLeftEye{0, 5, 6};
constexpr EyeChannels kRightEye{7, 12, 13};

void blink_eye(std::span<float> coefficients, const EyeChannels& eye, float b) {
  if (b <= 0) return;
  float& lid = coefficients[eye.blink];
  float& squint = coefficients[eye.squint];
  lid = std::max(lid, b);
  squint = std::min(1.0f, squint + static_cast<float>(kSquintOfBlink) * b);
  coefficients[eye.wide] *= 1 - b;
}

}  // namespace

double blink_shape(const BlinkEvent& event, double t) {
  if (t <= 0 || t >= event.seconds()) return 0;
  if (t < event.closing_s) return smooth_step(t / event.closing_s);
  t -= event.closing_s;
  if (t <= event.hold_s) return 1;
  return std::pow(1 - smooth_step((t - event.hold_s) / event.opening_s), 0.8);
}

LidClosure lid_closure(std::span<const BlinkEvent> events, double t_s) {
  LidClosure closure;
  for (const BlinkEvent& e : events) {
    const double t = t_s - e.onset_s;
    const double left = e.amplitude * blink_shape(e, t);
    const double right = e.amplitude * e.right_gain * blink_shape(e, t - e.right_delay_s);
    closure.left = std::max(closure.left, static_cast<float>(left));
    closure.right = std::max(closure.right, static_cast<float>(std::min(1.0, right)));
  }
  return closure;
}

BlinkEvent draw_blink(Rng& rng) {
  BlinkEvent e;
  e.closing_s = 1e-3 * std::clamp(rng.normal(78, 12), 50.0, 120.0);
  e.hold_s = 1e-3 * std::clamp(rng.normal(22, 12), 5.0, 60.0);
  e.opening_s = 1e-3 * std::clamp(rng.normal(190, 35), 120.0, 300.0);
  const bool is_partial = rng.chance(kPartialBlinkProbability);
  const double u = rng.uniform();
  e.amplitude = is_partial ? 0.4 + 0.35 * u : 0.92 + 0.08 * u;
  e.right_delay_s = rng.normal(0, 0.003);
  e.right_gain = rng.normal(1, 0.02);
  return e;
}

void apply_blink(std::span<float> coefficients, LidClosure closure) {
  contract(coefficients.size() >= kNumArkit,
           "apply_blink: a frame must start with the 52 ARKit coefficients");
  blink_eye(coefficients, kLeftEye, closure.left);
  blink_eye(coefficients, kRightEye, closure.right);
}

void apply_blinks(Motion& motion, std::span<const BlinkEvent> events) {
  const std::int64_t num_frames = motion.num_frames();
  // Each event touches its own few frames, so the cost does not grow with frames times events.
  std::vector<LidClosure> closures(static_cast<std::size_t>(num_frames));
  for (const BlinkEvent& e : events) {
    const double first = (e.onset_s + std::min(0.0, e.right_delay_s)) * motion.fps;
    const double last = (e.onset_s + e.seconds() + std::max(0.0, e.right_delay_s)) * motion.fps;
    const double end = static_cast<double>(num_frames) - 1;
    for (double n = std::max(0.0, std::floor(first)); n <= std::min(end, std::ceil(last)); ++n) {
      const LidClosure one = lid_closure({&e, 1}, n / motion.fps);
      LidClosure& all = closures[static_cast<std::size_t>(n)];
      all.left = std::max(all.left, one.left);
      all.right = std::max(all.right, one.right);
    }
  }
  for (std::int64_t n = 0; n < num_frames; ++n)
    apply_blink(motion.frame(n), closures[static_cast<std::size_t>(n)]);
}

std::vector<std::uint8_t> blink_onsets(std::span<const BlinkEvent> events, std::int64_t num_frames,
                                       double fps) {
  std::vector<std::uint8_t> onsets(static_cast<std::size_t>(num_frames));
  for (const BlinkEvent& e : events) {
    const double n = std::round(e.onset_s * fps);
    if (n >= 0 && n < static_cast<double>(num_frames)) onsets[static_cast<std::size_t>(n)] = 1;
  }
  return onsets;
}

}  // namespace mien
