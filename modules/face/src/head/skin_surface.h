#pragma once
#include "head/base_surface.h"

namespace mien::head {

inline constexpr Vec3d kEyeCentre{3.15, 2.72, 6.62};  ///< of the left eyeball, cm
inline constexpr double kEyeRadius = 1.30;
inline constexpr double kLidGap = 0.11;  ///< between eyeball and lid surface

/// Depth of the lid surface at a frontal position: a sphere around the nearer eyeball's centre, stretched in
/// x. Outside of its outline it falls away steeply.
double lid_z(double x, double y, double radius = kEyeRadius + kLidGap);

/// The finished skin: base, features and the bulge of the eyeballs under the lids (spec section 3).
Vec3d skin_point(ChartPoint at);
/// Depth of the skin whose base point is seen from the front at (x, y).
double skin_z(double x, double y);

struct SurfaceFrame {
  Vec3d point, normal;  ///< normal of unit length, outwards
};
SurfaceFrame skin_frame(double x, double y);

}  // namespace mien::head
