#include "mien/transfer/surface.h"

#include <gtest/gtest.h>

#include <cmath>

#include "../src/nearest.h"
#include "mien/base/random.h"
#include "sheet.h"

namespace mien {
namespace {

TEST(Surface, NumbersComponentsInTheOrderOfTheirVertices) {
  const std::vector<Triangle> triangles = {{5, 4, 3}, {0, 2, 6}};
  EXPECT_EQ(components(8, triangles), (std::vector<std::uint32_t>{0, 1, 0, 2, 2, 2, 0, 3}));
  EXPECT_TRUE(components(0, {}).empty());
}

TEST(Surface, LeavesOutVerticesWithTheirTriangles) {
  const Surface whole = sheet(3, 3);
  std::vector<bool> excluded(9);
  excluded[0] = true;
  const SurfacePart part = part_without(whole, excluded);
  EXPECT_EQ(part.surface.triangles.size(), 7u);
  EXPECT_EQ(part.whole, (std::vector<std::uint32_t>{1, 2, 3, 4, 5, 6, 7, 8}));
  for (std::size_t v = 0; v < part.whole.size(); ++v)
    EXPECT_EQ(part.surface.points[v], whole.points[part.whole[v]]);
  EXPECT_TRUE(part_without(whole, std::vector<bool>(9, true)).surface.points.empty());
}

TEST(Surface, NormalsOfTrianglesWithoutAreaAreZero) {
  const Surface line{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}}};
  EXPECT_EQ(triangle_normals(line).front(), Point3{});
  EXPECT_EQ(point_normals(line).front(), Point3{});
}

TEST(NearestPoint, FindsWhatAFullSearchFinds) {
  Rng rng(3);
  std::vector<Point3> points;
  for (int i = 0; i < 500; ++i) points.push_back({rng.normal(), rng.normal(), 0.1 * rng.normal()});
  const NearestPoint tree(points);
  const auto is_even = [](std::uint32_t i) { return i % 2 == 0; };
  for (int trial = 0; trial < 200; ++trial) {
    const Point3 place = {rng.normal(), rng.normal(), rng.normal()};
    std::uint32_t best = NearestPoint::kNone;
    double least = 0.5 * 0.5;
    for (std::uint32_t i = 0; i < points.size(); i += 2) {
      double square = 0;
      for (std::size_t a = 0; a < 3; ++a) square += (points[i][a] - place[a]) * (points[i][a] - place[a]);
      if (square < least) least = square, best = i;
    }
    EXPECT_EQ(tree.find(place, 0.5, is_even), best);
  }
  EXPECT_EQ(NearestPoint({}).find({0, 0, 0}, INFINITY, is_even), NearestPoint::kNone);
}

}  // namespace
}  // namespace mien
