#include <algorithm>

#include "head/curves.h"
#include "head/features.h"
#include "head/parts.h"

namespace mien::head {
namespace {

constexpr Rgb kSkin = {0.80, 0.565, 0.455}, kCavity = {0.34, 0.10, 0.10};
constexpr Rgb kLip = {0.69, 0.335, 0.31}, kInnerLip = {0.52, 0.20, 0.19};
constexpr Rgb kLashes = {0.25, 0.12, 0.10}, kUpperEdge = {0.20, 0.11, 0.09}, kLowerEdge = {0.72, 0.42, 0.37};

// Blood under the skin of cheeks, nose and chin.
struct Blush {
  double amount;
  Bump where;
};
constexpr std::array<Blush, 4> kBlushes = {{{0.9, {3.9, -0.7, 1.6, 1.2, 2, true}},
                                            {0.7, {0, -0.9, 0.9, 0.6}},
                                            {0.35, {1.0, -1.3, 0.5, 0.5, 2, true}},
                                            {0.25, {0, -7.5, 1.2, 0.8}}}};
constexpr Bump kUnderEye = {3.1, 1.6, 1.5, 0.5, 2, true}, kNostril = {0.52, -1.74, 0.30, 0.17, 3, true};

// Share of the second colour on a ring.
struct RingShare {
  std::size_t ring;
  double share;
};
constexpr std::array<RingShare, 5> kLipShares = {{{1, 0.45}, {2, 1}, {3, 1}, {4, 0.95}, {5, 0.75}}};
constexpr std::array<RingShare, 5> kLidShares = {{{4, 0.06}, {5, 0.14}, {6, 0.42}, {7, 0.30}, {8, 0.2}}};

void mix(Rgb& color, const Rgb& with, double share) {
  for (std::size_t i = 0; i < 3; ++i) color[i] = color[i] * (1 - share) + with[i] * share;
}

Rgb face_color(Vec3d p) {
  constexpr Rgb kBlushTint = {0.02, -0.075, -0.06}, kShadowTint = {0.6, 1, 0.7};
  constexpr double kNostrilFrontZ = 8;
  const double front = smooth_step(1, 4, p.z);
  double red = 0;
  for (const Blush& b : kBlushes) red += b.amount * bump(p.x, p.y, b.where);
  const double shadow = 0.05 * bump(p.x, p.y, kUnderEye) * front;
  const double nostril =
      p.z > kNostrilFrontZ ? std::clamp(1.25 * bump(p.x, p.y, kNostril) * front, 0.0, 1.0) : 0;
  Rgb color = kSkin;
  for (std::size_t i = 0; i < 3; ++i)
    color[i] = (color[i] + front * red * kBlushTint[i] - shadow * kShadowTint[i]) * (1 - 0.75 * nostril);
  return color;
}

}  // namespace

std::vector<Rgb> skin_colors(const HeadSkin& skin) {
  std::vector<Rgb> colors;
  for (std::size_t v = 0; v < skin.positions.size(); ++v)
    colors.push_back(skin.zones[v] == Zone::cavity ? kCavity : face_color(skin.positions[v]));
  const MouthLoop& mouth = skin.mouth;
  for (const auto& [ring, share] : kLipShares)
    for (std::size_t m = 0; m < kMouthLoop; ++m) {
      const double s2 = mouth.along[m] * mouth.along[m];
      mix(colors[mouth.rings[ring][m]], kLip, share * (1 - 0.35 * s2 * s2 * s2));  // paler at the corners
    }
  for (std::size_t ring = kContactRing; ring < kFirstCavityRing; ++ring)
    for (const auto v : mouth.rings[ring]) mix(colors[v], kInnerLip, 0.5);
  for (const EyeLoopOf& eye : skin.eyes) {
    for (const auto& [ring, share] : kLidShares)
      for (std::size_t m = 0; m < kEyeLoop; ++m)
        mix(colors[eye.rings[ring][m]], kLashes, eye.upper[m] ? share : share * 0.5);
    for (std::size_t m = 0; m < kEyeLoop; ++m)
      colors[eye.rings[kLidEdgeRing + 1][m]] = eye.upper[m] ? kUpperEdge : kLowerEdge;
  }
  for (Rgb& color : colors)
    for (double& channel : color) channel = std::clamp(channel, 0.0, 1.0);
  return colors;
}

}  // namespace mien::head
