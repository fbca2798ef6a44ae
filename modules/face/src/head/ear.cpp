#include <algorithm>
#include <numbers>

#include "head/curves.h"
#include "head/parts.h"

namespace mien::head {
namespace {

// Relief of the ear along a ray from its middle (0) to its rim (1): height away from the head, cm.
struct ReliefPoint {
  double radius, height;
};
constexpr std::array<ReliefPoint, 13> kRelief = {{{0, 0.18},
                                                  {0.12, 0.12},
                                                  {0.26, -0.02},
                                                  {0.40, 0.05},
                                                  {0.52, 0.36},
                                                  {0.60, 0.46},
                                                  {0.70, 0.30},
                                                  {0.80, 0.34},
                                                  {0.90, 0.62},
                                                  {0.97, 0.62},
                                                  {1.0, 0.45},
                                                  {0.97, 0.22},
                                                  {0.80, 0.05}}};

}  // namespace

Part build_ear(BodySide side) {
  constexpr int kAround = 40;
  constexpr Rgb kColor = {0.80, 0.535, 0.425};
  Part part;
  for (const ReliefPoint& ring : kRelief)
    for (int k = 0; k < kAround; ++k) {
      const double angle = static_cast<double>(k) / kAround * 2 * std::numbers::pi;
      const double c = std::cos(angle), s = std::sin(angle);
      // Outline seen from the side: `back` away from the face, `up`.
      const double lobe = smooth_step(-0.2, -1.0, s);
      const double back = (1.45 * c + 0.25 * s + 0.25) * (1 - 0.30 * lobe) - 0.22 * lobe;
      const double up = 2.75 * s + 0.2 + 0.22 * lobe;
      // No relief where the ear grows out of the head, little on the lobe.
      double relief = ring.height * (1 - 0.9 * smooth_step(0.2, -0.9, c));
      const double on_lobe = smooth_step(-0.55, -0.95, s);
      relief = relief * (1 - on_lobe) +
               on_lobe * (ring.radius < 0.95 ? 0.25 * ring.radius + 0.05 : ring.height * 0.6);
      const double e = back * ring.radius + 0.10 * (1 - ring.radius);
      const double h = up * ring.radius + 0.15 * (1 - ring.radius);
      // The rim stands away from the head the more, the farther back it is.
      const double out = relief + 0.42 * smooth_step(-0.6, 1.2, e) * std::max(e + 0.6, 0.0);
      const Vec3d p{7.02 + out - 0.28, 0.55 + h + 0.12 * e, -0.55 - e};
      part.positions.push_back(side == BodySide::left ? p : mirrored(p));
    }
  part.triangles = sheet_triangles(static_cast<int>(kRelief.size()), kAround, true);
  // Columns run from back to top: seen from outside that is clockwise on the left.
  if (side == BodySide::left) turn_around(part.triangles);
  part.colors.assign(part.positions.size(), kColor);
  return part;
}

}  // namespace mien::head
