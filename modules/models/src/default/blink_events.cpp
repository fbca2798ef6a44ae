#include "blink_events.h"

#include <algorithm>

namespace mien::default_model {
namespace {

constexpr std::uint32_t kBlinkStream = 2;
constexpr double kMargin = 0.1;  // the right eye may be a little later

BlinkEvent blink_of(Event event) {
  BlinkEvent blink = draw_blink(event.rng);
  blink.onset_s = static_cast<double>(event.frame) / kMotionFps;
  return blink;
}

}  // namespace

BlinkEvents::BlinkEvents(const EventPath<Tensor>& path, std::uint64_t seed)
    : draw_(path, seed, kBlinkStream) {}

void BlinkEvents::add_step(const Tensor& speech, const Tensor& c, const KeptFace* kept) {
  EventRule rule;
  if (kept != nullptr)
    rule = {kept->blink_class(draw_.next_frame(), draw_.kind().frames), [&](const Event& event) {
              const BlinkEvent blink = blink_of(event);
              return kept->may_blink(blink.onset_s, blink.onset_s + blink.seconds() + kMargin);
            }};
  if (const auto drawn = draw_.step(speech, c, c, rule)) events_.push_back(blink_of(*drawn));
}

LidClosure BlinkEvents::closure(std::int64_t n) {
  const double t = static_cast<double>(n) / kMotionFps;
  std::erase_if(events_, [&](const BlinkEvent& e) { return e.onset_s + e.seconds() + kMargin < t; });
  return lid_closure(events_, t);
}

}  // namespace mien::default_model
