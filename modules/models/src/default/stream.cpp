#include "mien/models/default/stream.h"

#include "hearing.h"
#include "performer.h"

namespace mien {

namespace dm = default_model;

struct DefaultStream::State {
  State(const DefaultModel& model, const PerformOptions& options)
      : hearing(model), performer(model, options) {}

  dm::Hearing hearing;
  dm::Performer performer;
  dm::Heard heard;
};

DefaultStream::DefaultStream(const DefaultModel& model, const PerformOptions& options)
    : state_(std::make_unique<State>(model, options)) {}
DefaultStream::DefaultStream(DefaultStream&&) noexcept = default;
DefaultStream& DefaultStream::operator=(DefaultStream&&) noexcept = default;
DefaultStream::~DefaultStream() = default;

void DefaultStream::push(std::span<const float> samples) { state_->hearing.push(samples); }
void DefaultStream::finish() { state_->hearing.finish(); }

bool DefaultStream::pop(std::span<float, kNumChannels> frame) {
  State& s = *state_;
  if (s.hearing.num_frames() >= 0 && s.performer.next() >= s.hearing.num_frames()) return false;
  while (!s.performer.is_ready()) {
    if (!s.hearing.hear(s.heard)) return false;
    s.performer.hear(s.heard);
  }
  s.performer.compose(s.hearing, frame);
  s.hearing.forget_before(s.performer.next());
  return true;
}

}  // namespace mien
