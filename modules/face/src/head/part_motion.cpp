#include "head/part_motion.h"

#include <algorithm>
#include <limits>

#include "head/curves.h"
#include "head/jaw_motion.h"
#include "head/skin_surface.h"
#include "mien/core/arkit.h"

namespace mien::head {
namespace {

template <class Motion>
Offsets offsets_by(const Part& part, const Motion& motion) {
  Offsets out;
  for (const Vec3d& p : part.positions) out.push_back(motion(p));
  return out;
}

Offsets tongue_out(const Part& tongue) {
  constexpr double kReach = 2.7, kLift = 0.62, kDrop = 0.75;  // cm: over the lower teeth and lip, then down
  const auto [back, front] = std::minmax_element(tongue.positions.begin(), tongue.positions.end(),
                                                 [](const Vec3d& a, const Vec3d& b) { return a.z < b.z; });
  return offsets_by(tongue, [from = back->z, to = front->z](const Vec3d& p) {
    const double u = smooth_step(from, to, p.z);
    return Vec3d{0, kLift * smooth_step(0.15, 0.6, u) - kDrop * std::clamp(u - 0.62, 0.0, 1.0),
                 kReach * std::pow(u, 1.6)};
  });
}

}  // namespace

std::vector<Offsets> eyeball_shapes(const Part& eye, BodySide side) {
  constexpr double kUpDownDeg = 24, kSidewaysDeg = 28;
  const int sign = static_cast<int>(side);
  const Vec3d centre{sign * kEyeCentre.x, kEyeCentre.y, kEyeCentre.z};
  const std::string suffix = side == BodySide::left ? "Left" : "Right";
  std::vector<Offsets> shapes(kNumArkit);
  const auto turn = [&](const std::string& way, double about_x, double about_y) {
    shapes[arkit_index("eyeLook" + way + suffix)] = offsets_by(eye, [&](const Vec3d& p) {
      return rotated_about_y(rotated_about_x(p, about_x, centre), about_y, centre) - p;
    });
  };
  turn("Up", -kUpDownDeg, 0);
  turn("Down", kUpDownDeg, 0);
  turn("In", 0, -sign * kSidewaysDeg);
  turn("Out", 0, sign * kSidewaysDeg);
  return shapes;
}

std::vector<Offsets> teeth_shapes(const Part& teeth, Jaw jaw) {
  std::vector<Offsets> shapes(kNumArkit);
  if (jaw == Jaw::upper) return shapes;
  for (std::size_t k = 0; k < kNumArkit; ++k)
    if (const auto motion = jaw_motion(arkit_names()[k])) shapes[k] = offsets_by(teeth, *motion);
  return shapes;
}

std::vector<Offsets> tongue_shapes(const Part& tongue) {
  std::vector<Offsets> shapes(kNumArkit);
  for (std::size_t k = 0; k < kNumArkit; ++k) {
    const auto name = arkit_names()[k];
    if (const auto motion = jaw_motion(name)) {
      const double share = name == "jawForward" ? 0.6 : 0.95;
      shapes[k] = offsets_by(tongue, [&](const Vec3d& p) { return share * (*motion)(p); });
    } else if (name == "tongueOut") {
      shapes[k] = tongue_out(tongue);
    }
  }
  return shapes;
}

std::vector<Offsets> follow_skin(const Part& part, const HeadSkin& skin,
                                 const std::vector<Offsets>& skin_shapes) {
  constexpr std::size_t kNeighbours = 6;
  constexpr double kSoftening = 0.05;  // cm: no neighbour takes all
  struct Follow {
    std::uint32_t vertex;
    double weight;
  };
  std::vector<std::array<Follow, kNeighbours>> bindings;
  for (const Vec3d& p : part.positions) {
    std::vector<std::pair<double, std::uint32_t>> by_distance;
    for (std::uint32_t v = 0; v < skin.positions.size(); ++v)
      by_distance.emplace_back(length(skin.positions[v] - p), v);
    std::partial_sort(by_distance.begin(), by_distance.begin() + kNeighbours, by_distance.end());
    std::array<Follow, kNeighbours> binding{};
    double sum = 0;
    for (std::size_t i = 0; i < kNeighbours; ++i) {
      const double near = by_distance[i].first + kSoftening;
      binding[i] = {by_distance[i].second, 1 / (near * near)};
      sum += binding[i].weight;
    }
    for (Follow& f : binding) f.weight /= sum;
    bindings.push_back(binding);
  }
  std::vector<Offsets> shapes;
  for (const Offsets& field : skin_shapes) {
    Offsets out(bindings.size());
    for (std::size_t i = 0; i < out.size(); ++i)
      for (const Follow& f : bindings[i]) out[i] += f.weight * field[f.vertex];
    shapes.push_back(std::move(out));
  }
  return shapes;
}

}  // namespace mien::head
