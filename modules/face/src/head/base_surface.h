#pragma once
#include "head/vec3d.h"

namespace mien::head {

/// A place on the head: azimuth in radians (0 in front, positive to the character's left, -pi ... pi) and
/// station number (0 at the cut of the neck, 17 at the crown; 8 is the mouth line, 12 the eye line).
struct ChartPoint {
  double azimuth = 0, station = 0;
};

inline constexpr double kLastStation = 17;

/// The smooth head without features: closed sections between front, side and back profiles (spec section 1).
Vec3d base_point(ChartPoint at);

/// The place whose base point is seen from the front at (x, y): damped Newton steps on finite differences.
ChartPoint find_in_front(double x, double y);

}  // namespace mien::head
