#include "event_draw.h"

#include <algorithm>
#include <cmath>

#include "mien/base/hash.h"

namespace mien::default_model {
namespace {

// Logarithm of the odds of any class but the first.
double log_odds(const Tensor& logits) {
  const auto all = logits.values();
  const float largest = *std::max_element(all.begin() + 1, all.end());
  double sum = 0;
  for (const float logit : all.subspan(1)) sum += std::exp(static_cast<double>(logit - largest));
  return std::log(sum) + static_cast<double>(largest - all.front());
}

}  // namespace

EventDraw::EventDraw(const EventPath<Tensor>& path, std::uint64_t seed, std::uint32_t stream,
                     Sharpening sharpening)
    : path_(path),
      seed_(seed),
      stream_(stream),
      sharpening_(sharpening),
      history_(path.kind),
      state_({1, path.hidden}),
      unknown_style_state_({1, path.hidden}) {}

std::optional<Event> EventDraw::step(const Tensor& speech, const Tensor& c, const Tensor& unknown_style,
                                     const EventRule& rule) {
  using B = Operations<Tensor>;
  const EventKind& kind = path_.kind;
  const Tensor heard =
      B::columns(speech, speech.width() - kind.groups * path_.width, kind.groups * path_.width);
  const Tensor history({1, kind.num_history()}, history_.numbers());
  const Tensor out = path_(heard, history, c, state_);
  Tensor logits = B::columns(out, 0, kind.num_classes());
  if (sharpening_.strength != 0) {
    const Tensor other = path_(heard, history, unknown_style, unknown_style_state_);
    const double shift =
        sharpening_.strength * (log_odds(B::columns(other, 0, kind.num_classes())) - sharpening_.neutral);
    for (float& logit : logits.values().subspan(1)) logit += static_cast<float>(shift);
  }
  const Tensor probabilities = softmax_last(logits);
  const auto step = static_cast<std::uint64_t>(num_steps_);
  double rest = NoiseField(seed_, stream_).uniform(step, 0);
  int drawn = 0;
  for (const float p : probabilities.values()) {
    rest -= static_cast<double>(p);
    if (rest < 0) break;
    ++drawn;
  }
  if (drawn == kind.num_classes()) drawn = 0;  // rounding left the sum below the drawn number
  const Event event{next_frame() + drawn - 1, kind.has_size ? static_cast<double>(out.values().back()) : 0.0,
                    Rng(hash_combine(hash_combine(seed_, stream_), step))};
  ++num_steps_;
  if (drawn != 0 && (rule.known || (rule.fits && !rule.fits(event)))) drawn = 0;
  history_.add(rule.known.value_or(drawn));
  if (drawn == 0) return std::nullopt;
  return event;
}

}  // namespace mien::default_model
