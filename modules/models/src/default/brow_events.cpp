#include "brow_events.h"

#include <algorithm>
#include <cmath>

namespace mien::default_model {
namespace {

constexpr std::uint32_t kBrowStream = 4;
constexpr double kMotionFps = 60;

// What the path hears of accents is uncertain; drawn as it says, more than half of the raises miss them.
// Sharpened, they keep to the accents that are surest. `neutral` keeps the number of raises about as it is
// (docs/quality.md).
constexpr Sharpening kSharpening{2, -2.0};

}  // namespace

BrowEvents::BrowEvents(const EventPath<Tensor>& path, std::uint64_t seed)
    : draw_(path, seed, kBrowStream, kSharpening) {}

void BrowEvents::add_step(const Tensor& speech, const Tensor& c, const Tensor& unknown_style) {
  auto drawn = draw_.step(speech, c, unknown_style);
  if (!drawn) return;
  BrowRaise raise = draw_brow_raise(drawn->rng);
  raise.onset_s = static_cast<double>(drawn->frame) / kMotionFps;
  raise.amplitude =
      std::min(1.0, kTypicalRaise * std::exp(drawn->log_size) * drawn->rng.log_normal(0, kRaiseLogSpread));
  raises_.push_back(raise);
}

float BrowEvents::height(std::int64_t n) {
  const double t = static_cast<double>(n) / kMotionFps;
  std::erase_if(raises_, [&](const BrowRaise& r) { return r.onset_s + r.seconds() < t; });
  return brow_height(raises_, t);
}

}  // namespace mien::default_model
