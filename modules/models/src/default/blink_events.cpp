#include "blink_events.h"

#include <algorithm>

#include "mien/base/hash.h"

namespace mien::default_model {
namespace {

constexpr std::uint32_t kClassStream = 2;
constexpr double kMotionFps = 60;

}  // namespace

BlinkEvents::BlinkEvents(const DefaultModel& model, std::uint64_t seed)
    : model_(model), seed_(seed), state_({1, model.metadata().sizes.blink_hidden}) {}

void BlinkEvents::add_chunk(const Tensor& speech, const Tensor& c) {
  const Tensor logits =
      model_.network().blink(speech, Tensor({1, kNumBlinkClasses + 1}, history_.numbers()), c, state_);
  const Tensor probabilities = softmax_last(logits);
  double rest = NoiseField(seed_, kClassStream).uniform(static_cast<std::uint64_t>(num_chunks_), 0);
  int drawn = 0;
  for (const float p : probabilities.values()) {
    rest -= static_cast<double>(p);
    if (rest < 0) break;
    ++drawn;
  }
  if (drawn == kNumBlinkClasses) drawn = 0;  // rounding left the sum below the drawn number
  history_.add(drawn);
  if (drawn > 0) {
    Rng rng(hash_combine(hash_combine(seed_, kClassStream), static_cast<std::uint64_t>(num_chunks_)));
    BlinkEvent event = draw_blink(rng);
    event.onset_s = static_cast<double>(num_chunks_ * kChunkFrames + drawn - 1) / kMotionFps;
    events_.push_back(event);
  }
  ++num_chunks_;
}

LidClosure BlinkEvents::closure(std::int64_t n) {
  const double t = static_cast<double>(n) / kMotionFps;
  constexpr double kMargin = 0.1;  // the right eye may be a little later
  std::erase_if(events_, [&](const BlinkEvent& e) { return e.onset_s + e.seconds() + kMargin < t; });
  return lid_closure(events_, t);
}

}  // namespace mien::default_model
