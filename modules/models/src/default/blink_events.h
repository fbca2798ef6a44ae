#pragma once
#include <vector>

#include "event_draw.h"
#include "kept_face.h"
#include "mien/motion/blink.h"

namespace mien::default_model {

/// Draws blinks from the blink path, chunk after chunk, and gives the lids' closure.
class BlinkEvents {
 public:
  /// The path must outlive it.
  BlinkEvents(const EventPath<Tensor>& path, std::uint64_t seed);
  /// Decides whether and when a blink begins in the next chunk. speech [1, 3 W], c [1, C]. `kept` is what an
  /// edit keeps, or null: blinks of the kept lids are known, and new ones take place between them.
  void add_step(const Tensor& speech, const Tensor& c, const KeptFace* kept = nullptr);
  /// Closure at 60 fps frame n, in order of n; forgets blinks that are over.
  LidClosure closure(std::int64_t n);

 private:
  EventDraw draw_;
  std::vector<BlinkEvent> events_;
};

}  // namespace mien::default_model
