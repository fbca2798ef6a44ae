#include "mien/models/default/event_history.h"

#include <cmath>

namespace mien::default_model {
namespace {

constexpr std::int64_t kFramesBefore = 96;  // at the start of a recording it is as if 1.6 s had passed

}  // namespace

EventHistory::EventHistory(const EventKind& kind) : kind_(kind), steps_since_(kFramesBefore / kind.frames) {}

std::vector<float> EventHistory::numbers() const {
  std::vector<float> out(static_cast<std::size_t>(kind_.num_history()));
  out[static_cast<std::size_t>(previous_)] = 1;
  const double seconds_per_step = static_cast<double>(kind_.frames) / kMotionFps;
  out.back() = static_cast<float>(std::log1p(seconds_per_step * static_cast<double>(steps_since_)));
  return out;
}

void EventHistory::add(int event_class) {
  previous_ = event_class;
  steps_since_ = event_class == 0 ? steps_since_ + 1 : 0;
}

}  // namespace mien::default_model
