#include <numbers>

#include "head/parts.h"
#include "head/skin_surface.h"

namespace mien::head {
namespace {

// Soft tissue between the lids and the eyeball, which would otherwise leave a gap that shows the inside of
// the head.
struct EyeCorner {
  Vec3d centre, radii;  // of the left eye, cm
  Rgb color;
};
constexpr std::array<EyeCorner, 2> kCorners = {{
    {{1.82, 2.67, 7.04}, {0.34, 0.27, 0.32}, {0.76, 0.44, 0.39}},  // caruncle, beside the nose
    {{4.52, 2.84, 6.96}, {0.32, 0.26, 0.30}, {0.76, 0.50, 0.45}},  // outer corner
}};
constexpr int kAround = 12, kRows = 6;

// The front half of an ellipsoid, from a ring around it to its tip.
void add_half_ellipsoid(Part& part, const EyeCorner& corner) {
  const auto first = static_cast<std::uint32_t>(part.positions.size());
  for (int row = 0; row < kRows; ++row) {
    const double rise = std::numbers::pi / 2 * row / kRows;
    for (int k = 0; k < kAround; ++k) {
      const double angle = 2 * std::numbers::pi * k / kAround;
      part.positions.push_back(corner.centre + Vec3d{corner.radii.x * std::cos(rise) * std::cos(angle),
                                                     corner.radii.y * std::cos(rise) * std::sin(angle),
                                                     corner.radii.z * std::sin(rise)});
    }
  }
  for (Triangle t : sheet_triangles(kRows, kAround, true)) {
    for (auto& v : t) v += first;
    part.triangles.push_back(t);
  }
  const auto tip = static_cast<std::uint32_t>(part.positions.size());
  part.positions.push_back(corner.centre + Vec3d{0, 0, corner.radii.z});
  for (std::uint32_t k = 0; k < kAround; ++k)
    part.triangles.push_back({tip - kAround + k, tip - kAround + (k + 1) % kAround, tip});
  part.colors.resize(part.positions.size(), corner.color);
}

}  // namespace

Part build_eye_corners(BodySide side) {
  Part part;
  for (const EyeCorner& corner : kCorners) add_half_ellipsoid(part, corner);
  if (side == BodySide::right) {
    for (Vec3d& p : part.positions) p = mirrored(p);
    turn_around(part.triangles);
  }
  return part;
}

}  // namespace mien::head
