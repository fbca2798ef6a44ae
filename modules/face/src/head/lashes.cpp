#include "head/lashes.h"

#include <cmath>

#include "head/skin_surface.h"

namespace mien::head {
namespace {

constexpr std::size_t kFirst = 1,
                      kLast = kEyeLoop / 2 - 1;  // ring positions of the upper lid without its corners
constexpr int kStepsPerSegment = 6;              // one lash every two steps
constexpr double kLength = 0.28;                 // cm, in the middle
constexpr double kRootShare = 0.45;              // of the length: where the strip splits into points
constexpr double kTipDroop = 0.60;               // closed lashes point down
constexpr Rgb kColor = {0.025, 0.018, 0.014};

// A place on the lid edge, with the direction in which a lash grows.
struct Root {
  Vec3d point, direction;
  double length = 0;
  Lashes::Follow follow;
};

Root root_at(const HeadSkin& skin, const EyeLoopOf& eye, std::size_t segment, double share) {
  constexpr double kUp = 0.55, kFan = 0.9;  // upwards; spread to both sides of the eye
  const EyeRing& edge = eye.rings[kLidEdgeRing];
  Root root;
  root.follow = {edge[segment], edge[segment + 1], share, 0};
  const Vec3d outer = (1 - share) * skin.positions[root.follow.from] + share * skin.positions[root.follow.to];
  const EyeRing& behind = eye.rings[kLidEdgeRing + 1];
  const Vec3d inner =
      (1 - share) * skin.positions[behind[segment]] + share * skin.positions[behind[segment + 1]];
  root.point = 0.7 * outer + 0.3 * inner;
  const double along = (1 - share) * eye.along[segment] + share * eye.along[segment + 1];
  const Vec3d centre{eye.sign * kEyeCentre.x, root.point.y, kEyeCentre.z};
  const Vec3d out = root.point - centre;
  const Vec3d direction = Vec3d{kFan * out.x, kUp * length(out), out.z};
  root.direction = (1 / length(direction)) * direction;
  root.length = kLength * (1 - 0.75 * std::pow(std::abs(along), 3)) * (1 + 0.25 * along);  // longest outside
  return root;
}

void add(Lashes& lashes, const Root& root, double share_of_length) {
  // Lashes leave the lid forwards and curl up.
  const double reach = share_of_length * root.length;
  const Vec3d curl{0, 0.35 * reach * share_of_length, 0};
  lashes.mesh.positions.push_back(root.point + reach * root.direction + curl);
  lashes.follow.push_back(root.follow);
  lashes.follow.back().droop = kTipDroop * share_of_length;
}

}  // namespace

Lashes build_lashes(const HeadSkin& skin, std::size_t eye_index) {
  const EyeLoopOf& eye = skin.eyes[eye_index];
  std::vector<Root> roots;
  for (std::size_t segment = kFirst; segment < kLast; ++segment)
    for (int k = 0; k < kStepsPerSegment; ++k)
      roots.push_back(root_at(skin, eye, segment, static_cast<double>(k) / kStepsPerSegment));
  roots.push_back(root_at(skin, eye, kLast - 1, 1));

  Lashes lashes;
  for (const Root& root : roots) add(lashes, root, 0);
  for (const Root& root : roots) add(lashes, root, kRootShare);
  const auto n = static_cast<std::uint32_t>(roots.size());
  lashes.mesh.triangles = sheet_triangles(2, static_cast<int>(n), false);
  for (std::uint32_t k = 1; k + 1 < n; k += 2) {
    add(lashes, roots[k], 1);
    const auto tip = static_cast<std::uint32_t>(lashes.mesh.positions.size() - 1);
    lashes.mesh.triangles.push_back({n + k - 1, n + k, tip});
    lashes.mesh.triangles.push_back({n + k, n + k + 1, tip});
  }
  // Rings run from the nose outwards: that is to the left for the left eye. Upper sides face up.
  if (eye.sign > 0) turn_around(lashes.mesh.triangles);
  lashes.mesh.colors.assign(lashes.mesh.positions.size(), kColor);
  return lashes;
}

std::vector<Offsets> lash_shapes(const Lashes& lashes, const std::vector<Offsets>& skin_shapes) {
  std::vector<Offsets> shapes;
  for (const Offsets& field : skin_shapes) {
    Offsets out;
    for (const Lashes::Follow& f : lashes.follow) {
      const Vec3d d = (1 - f.share) * field[f.from] + f.share * field[f.to];
      out.push_back({d.x, (1 + f.droop) * d.y, d.z});
    }
    shapes.push_back(std::move(out));
  }
  return shapes;
}

}  // namespace mien::head
