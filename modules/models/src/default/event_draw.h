#pragma once
#include <optional>

#include "mien/base/random.h"
#include "mien/models/default/event_history.h"
#include "mien/models/default/network.h"
#include "mien/models/runtime_parameters.h"

namespace mien::default_model {

/// Draws events from an event path, step after step. The path must outlive it.
class EventDraw {
 public:
  EventDraw(const EventPath<Tensor>& path, std::uint64_t seed, std::uint32_t stream);

  struct Event {
    std::int64_t frame;  ///< 60 fps frame in which it begins
    double log_size;     ///< expected logarithm of its size; 0 where the kind has none
    Rng rng;             ///< for its shape; depends on seed, stream and step alone
  };
  /// Decides whether and when an event begins in the next step. speech [1, 3 W]: the last groups, of which it
  /// reads as many as its kind says; c [1, C].
  std::optional<Event> step(const Tensor& speech, const Tensor& c);

 private:
  const EventPath<Tensor>& path_;
  std::uint64_t seed_;
  std::uint32_t stream_;
  EventHistory history_;
  Tensor state_;
  std::int64_t num_steps_ = 0;
};

}  // namespace mien::default_model
