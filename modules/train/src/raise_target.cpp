#include "raise_target.h"

#include <algorithm>

namespace mien::train {
namespace {

// A raise belongs to an accent when its centre lies this near to the frame before it: the truth's centres
// scatter by 40 ms around 20 ms before their accents. Accents are at least 280 ms apart.
constexpr std::int64_t kReach = 8;

}  // namespace

float raise_that_begins(const TrainingSet& set, std::int64_t take, const TrainingSet::Entry& entry,
                        std::int64_t n) {
  const auto inside = [&](std::int64_t at) { return at >= 0 && at < entry.num_frames; };
  const auto centred = [&](std::int64_t at) {
    return inside(at) ? set.brow_raise(take, entry.frame_start + at) : 0.0f;
  };
  const auto accented = [&](std::int64_t at) { return inside(at) && set.accent(entry.frame_start + at); };
  if (!inside(n)) return 0;
  const std::int64_t centre = n - 1;
  float amplitude = centred(centre);
  if (accented(n)) {
    for (std::int64_t d = 1; d <= kReach && amplitude == 0; ++d)
      amplitude = std::max(centred(centre - d), centred(centre + d));
    return amplitude;
  }
  if (amplitude == 0) return 0;
  for (std::int64_t d = -kReach; d <= kReach; ++d)
    if (accented(n + d)) return 0;  // it belongs there
  return amplitude;
}

}  // namespace mien::train
