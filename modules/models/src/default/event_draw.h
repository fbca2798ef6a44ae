#pragma once
#include <functional>
#include <optional>

#include "mien/base/random.h"
#include "mien/models/default/event_history.h"
#include "mien/models/default/network.h"
#include "mien/models/runtime_parameters.h"

namespace mien::default_model {

/// How much more decidedly than its path an EventDraw follows the speech: the logarithm l of the odds of an
/// event in a step becomes l + strength (l' - neutral), where l' is what the path says of a speaker of
/// unknown style. Style thus keeps its own effect on how often events happen. 0: drawn as the path says.
struct Sharpening {
  double strength = 0;
  double neutral = 0;
};

/// An event that was drawn.
struct Event {
  std::int64_t frame;  ///< 60 fps frame in which it begins
  double log_size;     ///< expected logarithm of its size; 0 where the kind has none
  Rng rng;             ///< for its shape; depends on seed, stream and step alone
};

/// What an edit says of a step: the class that the kept motion shows, of which nothing is drawn, or which
/// drawn events there is room for.
struct EventRule {
  std::optional<int> known{};
  std::function<bool(const Event&)> fits{};  ///< empty: all
};

/// Draws events from an event path, step after step. The path must outlive it.
class EventDraw {
 public:
  EventDraw(const EventPath<Tensor>& path, std::uint64_t seed, std::uint32_t stream,
            Sharpening sharpening = {});

  /// Decides whether and when an event begins in the next step. speech [1, 3 W]: the last groups, of which it
  /// reads as many as its kind says; c and the condition of the same with unknown style, [1, C] each.
  /// `rule` is what an edit says of the step.
  std::optional<Event> step(const Tensor& speech, const Tensor& c, const Tensor& unknown_style,
                            const EventRule& rule = {});
  /// The first frame of the step that comes next.
  [[nodiscard]] std::int64_t next_frame() const { return num_steps_ * path_.kind.frames + path_.kind.offset; }
  [[nodiscard]] const EventKind& kind() const { return path_.kind; }

 private:
  const EventPath<Tensor>& path_;
  std::uint64_t seed_;
  std::uint32_t stream_;
  Sharpening sharpening_;
  EventHistory history_;
  Tensor state_, unknown_style_state_;
  std::int64_t num_steps_ = 0;
};

}  // namespace mien::default_model
