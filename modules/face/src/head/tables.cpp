#include "head/tables.h"

#include <cmath>
#include <set>

#include "head/brow_curve.h"
#include "head/curves.h"
#include "head/handles.h"
#include "head/skin_surface.h"

namespace mien::head {
namespace {

// Positions in a ring that are landmarks. Eyes: from the character's right to its left, upper lid first.
constexpr std::array<std::size_t, 6> kRightEye = {14, 9, 5, 0, 23, 19}, kLeftEye = {0, 5, 9, 14, 19, 23};
constexpr std::array<std::size_t, 12> kOuterMouth = {0, 4, 9, 12, 15, 20, 24, 28, 32, 36, 40, 44};
constexpr std::array<std::size_t, 8> kInnerMouth = {0, 7, 12, 17, 24, 31, 36, 41};
constexpr std::size_t kOutlineRing = 1;  // border of the red of the lips

constexpr std::array<double, 5> kBrowX = {4.35, 3.6, 2.8, 2.0, 1.2};  // temple to nose, cm
constexpr std::array<double, 4> kNoseY = {3.0, 1.8, 0.6, -0.7};
constexpr std::array<double, 5> kNostrilX = {-0.95, -0.5, 0, 0.5, 0.95};
constexpr double kNostrilY = -1.95;

std::uint32_t nearest_grid_vertex(const HeadSkin& skin, Vec3d p) {
  std::uint32_t best = 0;
  double least = 1e300;
  for (std::uint32_t v = 0; v < skin.chart.size(); ++v) {
    const Vec3d d = skin.positions[v] - p;
    if (const double size = dot(d, d); size < least) least = size, best = v;
  }
  return best;
}

double brow_y(double x) { return brow_curve((x - kBrowStartX) / kBrowLength).y; }

}  // namespace

std::vector<std::uint32_t> landmarks68(const HeadSkin& skin) {
  constexpr double kJawStation = 4.35, kJawAzimuth = 1.42, kFrontZ = 0;
  std::vector<std::uint32_t> landmarks;
  for (const double azimuth : linear_space(-kJawAzimuth, kJawAzimuth, 17))
    landmarks.push_back(nearest_grid_vertex(skin, skin_point({azimuth, kJawStation})));
  const auto add = [&](double x, double y) { landmarks.push_back(nearest_in_front(skin, x, y, kFrontZ)); };
  for (const double x : kBrowX) add(-x, brow_y(x));
  for (auto x = kBrowX.rbegin(); x != kBrowX.rend(); ++x) add(*x, brow_y(*x));
  for (const double y : kNoseY) add(0, y);
  for (const double x : kNostrilX) add(x, kNostrilY);
  for (const auto m : kRightEye) landmarks.push_back(skin.eyes[1].rings[kLidEdgeRing][m]);
  for (const auto m : kLeftEye) landmarks.push_back(skin.eyes[0].rings[kLidEdgeRing][m]);
  for (const auto m : kOuterMouth) landmarks.push_back(skin.mouth.rings[kOutlineRing][m]);
  for (const auto m : kInnerMouth) landmarks.push_back(skin.mouth.rings[kContactRing][m]);
  return landmarks;
}

std::vector<std::uint32_t> lip_region(const HeadSkin& skin) {
  std::set<std::uint32_t> region;
  for (std::size_t ring = 1; ring <= 6; ++ring)
    region.insert(skin.mouth.rings[ring].begin(), skin.mouth.rings[ring].end());
  return {region.begin(), region.end()};
}

std::vector<std::uint32_t> upper_face_region(const HeadSkin& skin) {
  constexpr double kMinY = 0.2, kMaxAzimuth = 1.15, kMaxStation = 14.6;
  std::set<std::uint32_t> region;
  for (std::uint32_t v = 0; v < skin.chart.size(); ++v)
    if (skin.positions[v].y > kMinY && std::abs(skin.chart[v].azimuth) < kMaxAzimuth &&
        skin.chart[v].station < kMaxStation)
      region.insert(v);
  for (const EyeLoopOf& eye : skin.eyes)
    for (std::size_t ring = 1; ring <= kLidEdgeRing; ++ring)
      region.insert(eye.rings[ring].begin(), eye.rings[ring].end());
  return {region.begin(), region.end()};
}

std::map<std::string, std::vector<std::uint32_t>> named_rings(const HeadSkin& skin) {
  std::map<std::string, std::vector<std::uint32_t>> rings;
  for (std::size_t k = 0; k < skin.mouth.rings.size(); ++k)
    rings["mouth" + std::to_string(k)].assign(skin.mouth.rings[k].begin(), skin.mouth.rings[k].end());
  for (const EyeLoopOf& eye : skin.eyes)
    for (std::size_t k = 0; k < eye.rings.size(); ++k)
      rings[(eye.sign > 0 ? "eyeLeft" : "eyeRight") + std::to_string(k)].assign(eye.rings[k].begin(),
                                                                                eye.rings[k].end());
  return rings;
}

}  // namespace mien::head
