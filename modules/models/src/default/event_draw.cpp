#include "event_draw.h"

#include "mien/base/hash.h"

namespace mien::default_model {

EventDraw::EventDraw(const EventPath<Tensor>& path, std::uint64_t seed, std::uint32_t stream)
    : path_(path), seed_(seed), stream_(stream), history_(path.kind), state_({1, path.hidden}) {}

std::optional<EventDraw::Event> EventDraw::step(const Tensor& speech, const Tensor& c) {
  using B = Operations<Tensor>;
  const EventKind& kind = path_.kind;
  const std::int64_t heard = kind.groups * path_.width;
  const Tensor history({1, kind.num_history()}, history_.numbers());
  const Tensor out = path_(B::columns(speech, speech.width() - heard, heard), history, c, state_);
  const Tensor probabilities = softmax_last(B::columns(out, 0, kind.num_classes()));
  const auto step = static_cast<std::uint64_t>(num_steps_);
  double rest = NoiseField(seed_, stream_).uniform(step, 0);
  int drawn = 0;
  for (const float p : probabilities.values()) {
    rest -= static_cast<double>(p);
    if (rest < 0) break;
    ++drawn;
  }
  if (drawn == kind.num_classes()) drawn = 0;  // rounding left the sum below the drawn number
  history_.add(drawn);
  const std::int64_t first_frame = num_steps_++ * kind.frames + kind.offset;
  if (drawn == 0) return std::nullopt;
  return Event{first_frame + drawn - 1, kind.has_size ? static_cast<double>(out.values().back()) : 0.0,
               Rng(hash_combine(hash_combine(seed_, stream_), step))};
}

}  // namespace mien::default_model
