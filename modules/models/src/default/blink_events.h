#pragma once
#include <vector>

#include "mien/base/random.h"
#include "mien/models/default/blink_history.h"
#include "mien/models/default/default_model.h"
#include "mien/motion/blink.h"

namespace mien::default_model {

/// Draws blinks from the blink path, chunk after chunk, and gives the lids' closure.
class BlinkEvents {
 public:
  BlinkEvents(const DefaultModel& model, std::uint64_t seed);
  /// Decides whether and when a blink begins in the next chunk. speech [1, 3 W], c [1, C].
  void add_chunk(const Tensor& speech, const Tensor& c);
  /// Closure at 60 fps frame n, in order of n; forgets blinks that are over.
  LidClosure closure(std::int64_t n);

 private:
  const DefaultModel model_;
  std::uint64_t seed_;
  BlinkHistory history_;
  Tensor state_;
  std::int64_t num_chunks_ = 0;
  std::vector<BlinkEvent> events_;
};

}  // namespace mien::default_model
