#include <algorithm>
#include <numbers>

#include "head/brow_curve.h"
#include "head/curves.h"
#include "head/parts.h"
#include "head/skin_surface.h"

namespace mien::head {

FrontPosition brow_curve(double u) {
  return {kBrowStartX + kBrowLength * u,
          4.42 + 0.62 * std::sin(std::numbers::pi * (u * 0.80 + 0.06)) - 0.62 * u * u * u};
}

Part build_brow(BodySide side) {
  constexpr int kAlong = 22, kAcross = 5;
  constexpr double kBuriedEdge = -0.03;  // the strip's long sides lie under the skin
  constexpr Rgb kColor = {0.16, 0.10, 0.07};
  Part part;
  for (const double v : linear_space(-1, 1, kAcross))
    for (const double u : linear_space(0, 1, kAlong)) {
      const auto [x, y] = brow_curve(u);
      const double half_width =
          0.33 * std::sqrt(std::min(1.0, (u + 0.04) * 7)) * (1 - 0.80 * std::pow(u, 1.6));
      const SurfaceFrame frame = skin_frame(x, y + half_width * v);
      const double end = std::sqrt(std::clamp(1 - std::pow(2 * u - 1, 8), 0.0, 1.0));
      const double height = std::abs(v) == 1 ? kBuriedEdge : 0.05 + 0.10 * (1 - v * v) * end;
      const Vec3d p = frame.point + height * frame.normal;
      part.positions.push_back(side == BodySide::left ? p : mirrored(p));
    }
  part.triangles = sheet_triangles(kAcross, kAlong, false);
  if (side == BodySide::right) turn_around(part.triangles);
  part.colors.assign(part.positions.size(), kColor);
  return part;
}

}  // namespace mien::head
