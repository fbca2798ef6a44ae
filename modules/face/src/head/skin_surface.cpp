#include "head/skin_surface.h"

#include <algorithm>

#include "head/features.h"

namespace mien::head {
namespace {

// Maximum of a and b with a rounded edge of width k.
double smooth_max(double a, double b, double k) {
  const double h = std::clamp(0.5 + 0.5 * (a - b) / k, 0.0, 1.0);
  return b * (1 - h) + a * h + k * h * (1 - h);
}

}  // namespace

double lid_z(double x, double y, double radius) {
  constexpr double kStretch = 1.28;      // lids are wider than the eyeball
  constexpr double kFallBeyondEdge = 2;  // outside of the outline
  const double u = (std::abs(x) - kEyeCentre.x) / kStretch, v = y - kEyeCentre.y;
  const double d = radius * radius - u * u - v * v;
  return kEyeCentre.z + (d < 0 ? -kFallBeyondEdge * std::sqrt(-d) : std::sqrt(d));
}

Vec3d skin_point(ChartPoint at) {
  constexpr double kNearX = 2.4, kNearY = 1.6, kFrontZ = 3, kBlend = 0.22;
  Vec3d p = add_features(base_point(at), at.azimuth);
  const bool near_eye = std::abs(std::abs(p.x) - kEyeCentre.x) < kNearX &&
                        std::abs(p.y - kEyeCentre.y) < kNearY && p.z > kFrontZ;
  if (near_eye) p.z = smooth_max(p.z, lid_z(p.x, p.y), kBlend);
  return p;
}

double skin_z(double x, double y) { return skin_point(find_in_front(x, y)).z; }

SurfaceFrame skin_frame(double x, double y) {
  constexpr double kDifference = 2e-3;
  const ChartPoint at = find_in_front(x, y);
  const Vec3d p = skin_point(at);
  const Vec3d n = cross(skin_point({at.azimuth + kDifference, at.station}) - p,
                        skin_point({at.azimuth, at.station + kDifference}) - p);
  return {p, (1 / length(n)) * n};
}

}  // namespace mien::head
