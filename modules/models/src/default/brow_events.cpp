#include "brow_events.h"

#include <algorithm>
#include <cmath>

namespace mien::default_model {
namespace {

constexpr std::uint32_t kBrowStream = 4;

// What the path hears of accents is uncertain; drawn as it says, more than half of the raises miss them.
// Sharpened, they keep to the accents that are surest. `neutral` keeps the number of raises about as it is
// (docs/quality.md).
constexpr Sharpening kSharpening{2, -2.0};

BrowRaise raise_of(Event event) {
  BrowRaise raise = draw_brow_raise(event.rng);
  raise.onset_s = static_cast<double>(event.frame) / kMotionFps;
  raise.amplitude =
      std::min(1.0, kTypicalRaise * std::exp(event.log_size) * event.rng.log_normal(0, kRaiseLogSpread));
  return raise;
}

}  // namespace

BrowEvents::BrowEvents(const EventPath<Tensor>& path, std::uint64_t seed)
    : draw_(path, seed, kBrowStream, kSharpening) {}

void BrowEvents::add_step(const Tensor& speech, const Tensor& c, const Tensor& unknown_style,
                          const KeptFace* kept) {
  EventRule rule;
  if (kept != nullptr)
    rule = {kept->raise_class(draw_.next_frame(), draw_.kind().frames), [&](const Event& event) {
              const BrowRaise raise = raise_of(event);
              return kept->may_raise(raise.onset_s, raise.onset_s + raise.seconds());
            }};
  if (const auto drawn = draw_.step(speech, c, unknown_style, rule)) raises_.push_back(raise_of(*drawn));
}

float BrowEvents::height(std::int64_t n) {
  const double t = static_cast<double>(n) / kMotionFps;
  std::erase_if(raises_, [&](const BrowRaise& r) { return r.onset_s + r.seconds() < t; });
  return brow_height(raises_, t);
}

}  // namespace mien::default_model
