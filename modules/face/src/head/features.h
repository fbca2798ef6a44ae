#pragma once
#include "head/vec3d.h"

namespace mien::head {

/// A soft hill over the frontal plane: exp(-(((x-cx)/rx)^2 + ((y-cy)/ry)^2)^(power/2)).
struct Bump {
  double cx, cy, rx, ry;
  double power = 2;         ///< 2 is a Gaussian; more gives a flatter top and a steeper flank
  bool both_sides = false;  ///< the same hill at -cx
};
double bump(double x, double y, const Bump& shape);

/// The base point with nose, brow ridge, eye sockets, muzzle, chin and cheeks (spec section 2). All features
/// are functions of the frontal position and fade out towards the back.
Vec3d add_features(Vec3d base, double azimuth);

}  // namespace mien::head
