#include "blink_events.h"

#include <algorithm>

namespace mien::default_model {
namespace {

constexpr std::uint32_t kBlinkStream = 2;
constexpr double kMotionFps = 60;

}  // namespace

BlinkEvents::BlinkEvents(const EventPath<Tensor>& path, std::uint64_t seed)
    : draw_(path, seed, kBlinkStream) {}

void BlinkEvents::add_step(const Tensor& speech, const Tensor& c) {
  auto drawn = draw_.step(speech, c, c);
  if (!drawn) return;
  BlinkEvent event = draw_blink(drawn->rng);
  event.onset_s = static_cast<double>(drawn->frame) / kMotionFps;
  events_.push_back(event);
}

LidClosure BlinkEvents::closure(std::int64_t n) {
  const double t = static_cast<double>(n) / kMotionFps;
  constexpr double kMargin = 0.1;  // the right eye may be a little later
  std::erase_if(events_, [&](const BlinkEvent& e) { return e.onset_s + e.seconds() + kMargin < t; });
  return lid_closure(events_, t);
}

}  // namespace mien::default_model
