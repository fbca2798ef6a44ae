#pragma once
#include <vector>

#include "mien/models/default/network.h"

namespace mien::default_model {

inline constexpr std::int64_t kMotionFps = 60;  ///< frames a second of all motion of the default model

/// What an event path knows of earlier events: the class of the previous step (0 none, 1 + f onset in frame
/// f) and the time since the last onset.
class EventHistory {
 public:
  explicit EventHistory(const EventKind& kind);
  /// One-hot class of the previous step, then ln(1 + seconds since the last onset). [num_history]
  [[nodiscard]] std::vector<float> numbers() const;
  void add(int event_class);

 private:
  EventKind kind_;
  int previous_ = 0;
  std::int64_t steps_since_;
};

}  // namespace mien::default_model
