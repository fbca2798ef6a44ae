#pragma once
#include <algorithm>

namespace mien {

/// Rises from 0 at u <= 0 to 1 at u >= 1, level at both ends.
inline double smooth_step(double u) {
  u = std::clamp(u, 0.0, 1.0);
  return u * u * (3 - 2 * u);
}

}  // namespace mien
