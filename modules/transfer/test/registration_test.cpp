#include "mien/transfer/registration.h"

#include <gtest/gtest.h>

#include <cmath>

#include "../src/matrices.h"
#include "sheet.h"

namespace mien {
namespace {

// A turn by 0.7 about (1, 2, 2) / 3.
Matrix3 some_rotation() {
  const Point3 axis = {1.0 / 3, 2.0 / 3, 2.0 / 3};
  Matrix3 r{};
  const double c = std::cos(0.7), s = std::sin(0.7);
  const Matrix3 hat = {{{0, -axis[2], axis[1]}, {axis[2], 0, -axis[0]}, {-axis[1], axis[0], 0}}};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      r[i][j] = (i == j ? c : 0) + s * hat[i][j] + (1 - c) * axis[i] * axis[j];
  return r;
}

TEST(BestSimilarity, FindsScaleRotationAndOffset) {
  const Surface surface = sheet(5, 4);
  const Similarity made{2.5, some_rotation(), {3, -1, 2}};
  for (const bool is_flat : {false, true}) {
    std::vector<Point3> from, to;
    for (Point3 p : surface.points) {
      if (is_flat) p[2] = 0;
      from.push_back(p);
      to.push_back(made(p));
    }
    const Similarity found = best_similarity(from, to);
    EXPECT_NEAR(found.scale, 2.5, 1e-12);
    for (std::size_t i = 0; i < from.size(); ++i) EXPECT_NEAR(norm(found(from[i]) - to[i]), 0, 1e-12);
  }
}

TEST(BestSimilarity, NeverReflects) {
  std::vector<Point3> from, to;
  for (const Point3& p : sheet(5, 4).points) {
    from.push_back(p);
    to.push_back({-p[0], p[1], p[2] + 0.3 * p[0]});
  }
  const Matrix3 r = best_similarity(from, to).rotation;
  EXPECT_NEAR(dot(r[0], cross(r[1], r[2])), 1, 1e-12);
  const std::vector<Point3> one = {{1, 2, 3}}, place = {{4, 4, 4}};
  EXPECT_NEAR(norm(best_similarity(one, place)(one[0]) - place[0]), 0, 1e-12);
}

TEST(Registration, MeetsTheMarkersAndLiesOnTheTarget) {
  const Surface source = sheet(11, 11);
  Surface target = sheet(17, 15);
  for (Point3& p : target.points) p[2] += 0.15 * std::sin(2 * p[0]) * std::cos(p[1]);
  const std::vector<Marker> markers = {
      {0, 0}, {10, 16}, {110, 238}, {120, 254}, {60, 127}};  // corners, middle
  Progress progress;
  RegistrationOptions options;
  options.reach = 0.4;
  const auto places = register_surface(source, target, markers, options, progress);
  ASSERT_TRUE(places.has_value()) << places.error().message();
  for (const Marker& m : markers) EXPECT_EQ((*places)[m.source], target.points[m.target]);
  double worst = 0;
  for (const Point3& p : *places) {
    const double bulge = 0.6 * std::exp(-3 * (p[0] * p[0] + p[1] * p[1])) - 0.2 * p[0] * p[0] +
                         0.15 * std::sin(2 * p[0]) * std::cos(p[1]);
    worst = std::max(worst, std::abs(p[2] - bulge));
  }
  EXPECT_LT(worst, 0.05);  // the target's own triangles are up to 0.02 off this surface

  const auto pairs = pair_triangles({*places, source.triangles}, target, 0.4);
  std::vector<bool> paired(target.triangles.size()), used(source.triangles.size());
  for (const TrianglePair& pair : pairs) paired[pair.target] = used[pair.source] = true;
  for (const bool is_paired : paired) EXPECT_TRUE(is_paired);
  for (const bool is_used : used) EXPECT_TRUE(is_used);
  EXPECT_TRUE(pair_triangles({*places, source.triangles}, target, 1e-6).empty());
}

TEST(Registration, RefusesMarkersThatAreNotThereOrTwice) {
  const Surface surface = sheet(4, 4);
  Progress progress;
  const auto error = [&](std::vector<Marker> markers) {
    const auto result = register_surface(surface, surface, markers, {}, progress);
    return result.has_value() ? std::string() : result.error().message();
  };
  EXPECT_NE(error({{0, 0}, {16, 1}}).find("marker 2: its source vertex 16 does not exist"),
            std::string::npos);
  EXPECT_NE(error({{0, 0}, {1, 99}}).find("99"), std::string::npos);
  EXPECT_NE(error({{3, 0}, {3, 1}}).find("again, after marker 1"), std::string::npos);
  EXPECT_NE(error({}).find("there are none"), std::string::npos);
}

}  // namespace
}  // namespace mien
