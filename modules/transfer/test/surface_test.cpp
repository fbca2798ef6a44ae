#include "mien/transfer/surface.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

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

TEST(TouchingVertices, AreCopiesAlongACut) {
  const Surface whole = sheet(9, 7), cut = cut_along(whole, 9, 4);
  EXPECT_TRUE(touching_vertices(whole).empty());
  const auto ties = touching_vertices(cut);
  ASSERT_EQ(ties.size(), 7u);
  for (std::uint32_t j = 0; j < 7; ++j) EXPECT_EQ(ties[j], (Tie{j * 9 + 4, 63 + j}));
  Surface apart = cut;
  for (std::size_t v = 63; v < apart.points.size(); ++v) apart.points[v][0] += 0.01;  // of edges of 0.25
  EXPECT_TRUE(touching_vertices(apart).empty());
  for (std::size_t v = 63; v < apart.points.size(); ++v) apart.points[v][0] -= 0.009;
  EXPECT_EQ(touching_vertices(apart).size(), 7u);
  EXPECT_TRUE(touching_vertices({}).empty());
}

TEST(TouchingVertices, HangTogetherWhereSeveralPiecesMeet) {
  Surface pieces;  // four squares around one corner, each of its own vertices
  for (const double x : {-1.0, 0.0})
    for (const double y : {-1.0, 0.0}) {
      const auto first = static_cast<std::uint32_t>(pieces.points.size());
      for (const auto& [i, j] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}})
        pieces.points.push_back({x + i, y + j, 0});
      pieces.triangles.push_back({first, first + 1, first + 2});
      pieces.triangles.push_back({first, first + 2, first + 3});
    }
  std::vector<Triangle> joined = pieces.triangles;
  for (const Tie& tie : touching_vertices(pieces)) joined.push_back({tie.a, tie.b, tie.b});
  const auto component = components(pieces.points.size(), joined);
  for (const std::uint32_t c : component) EXPECT_EQ(c, 0u);
}

// Two lips that meet: borders at one place, but the surface does not go on from one to the other.
TEST(TouchingVertices, AreNotThoseOfLipsThatMeet) {
  const Surface lips{
      {{0, 0, 0}, {1, 0, 0}, {0, 0.2, 1}, {1, 0.2, 1}, {0, 0, 0}, {1, 0, 0}, {0, -0.2, 1}, {1, -0.2, 1}},
      {{0, 1, 2}, {1, 3, 2}, {5, 4, 6}, {5, 6, 7}}};
  const auto normals = point_normals(lips);
  ASSERT_LT(normals[0][1] * normals[4][1], 0);
  EXPECT_TRUE(touching_vertices(lips).empty());
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
