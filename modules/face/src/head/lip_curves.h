#pragma once
#include <cmath>

#include "head/curves.h"

namespace mien::head {

/// 1 at the left corner of the mouth, fading to 0 a little right of the middle.
inline double left_side(double along) { return std::pow(smooth_step(-0.45, 1.0, along), 1.15); }

/// 1 - |along|^power: 1 in the middle, 0 at the corners.
inline double middle(double along, double power) { return 1 - std::pow(std::abs(along), power); }

}  // namespace mien::head
