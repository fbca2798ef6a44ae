#include <algorithm>
#include <numbers>

#include "head/curves.h"
#include "head/parts.h"

namespace mien::head {

Part build_tongue(double contact_z) {
  constexpr int kAlong = 18, kAround = 20;  // a tube of ellipses from the root to the tip
  constexpr double kLength = 3.35, kRootDepth = 4.6, kMinHalfWidth = 0.02;
  constexpr Rgb kColor = {0.70, 0.32, 0.31};
  Part part;
  for (int i = 0; i < kAlong; ++i) {
    const double u = static_cast<double>(i) / (kAlong - 1);  // 0 root, 1 tip
    const double taper = std::pow(std::max(0.0, u - 0.30) / 0.705, 2.6);
    const double half_width =
        std::max((1.55 - 0.25 * u) * std::sqrt(std::clamp(1 - taper, 0.0, 1.0)), kMinHalfWidth);
    const double arch = 0.42 * std::sin(std::numbers::pi * std::min(1.0, (1 - u) * 0.75 + 0.05));
    const double top = kMouthLineY - 0.62 - 0.15 * u + arch;
    const double thickness = 0.62 * (1 - 0.45 * u) * std::sqrt(half_width / 1.55);
    for (int k = 0; k < kAround; ++k) {
      const double angle = 2 * std::numbers::pi * k / kAround;
      const double c = std::cos(angle), s = std::sin(angle);
      const double furrow = s > 0 ? 0.12 * gauss(half_width * c, 0, 0.22) : 0;
      const double y = top + (s < 0 ? thickness * s : 0.45 * thickness * s) - furrow;
      part.positions.push_back({half_width * c, y - 0.1, contact_z - kRootDepth + kLength * u});
    }
  }
  part.triangles = sheet_triangles(kAlong, kAround, true);
  Vec3d tip;
  const std::uint32_t last_ring = (kAlong - 1) * kAround;
  for (std::uint32_t k = 0; k < kAround; ++k) tip += (1.0 / kAround) * part.positions[last_ring + k];
  part.positions.push_back(tip + Vec3d{0, 0, 0.06});
  for (std::uint32_t k = 0; k < kAround; ++k)
    part.triangles.push_back({last_ring + k, last_ring + (k + 1) % kAround, last_ring + kAround});
  part.colors.assign(part.positions.size(), kColor);
  return part;
}

}  // namespace mien::head
