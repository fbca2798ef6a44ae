#pragma once
#include <vector>

#include "event_draw.h"
#include "kept_face.h"
#include "mien/motion/brow_raise.h"

namespace mien::default_model {

/// Draws raises of the brows from the brow path, four frames after four frames, and gives the brows' height.
class BrowEvents {
 public:
  /// The path must outlive it.
  BrowEvents(const EventPath<Tensor>& path, std::uint64_t seed);
  /// Decides whether and when a raise begins in the next step. speech [1, 3 W]; c and the condition of
  /// the same with unknown style, [1, C] each. `kept` as in BlinkEvents.
  void add_step(const Tensor& speech, const Tensor& c, const Tensor& unknown_style,
                const KeptFace* kept = nullptr);
  /// Height at 60 fps frame n, in order of n; forgets raises that are over.
  float height(std::int64_t n);

 private:
  EventDraw draw_;
  std::vector<BrowRaise> raises_;
};

}  // namespace mien::default_model
