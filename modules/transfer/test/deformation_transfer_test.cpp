#include "mien/transfer/deformation_transfer.h"

#include <gtest/gtest.h>

#include <cmath>

#include "../src/matrices.h"
#include "sheet.h"

namespace mien {
namespace {

std::vector<TrianglePair> all_pairs(const Surface& surface) {
  std::vector<TrianglePair> pairs;
  for (std::uint32_t t = 0; t < surface.triangles.size(); ++t) pairs.push_back({t, t});
  return pairs;
}

std::vector<Point3> bent(const Surface& surface) {
  std::vector<Point3> points;
  for (const Point3& p : surface.points)
    points.push_back({p[0] + 0.2 * p[1] * p[1], 1.1 * p[1] - 0.1 * p[0], p[2] + 0.3 * std::sin(2 * p[0])});
  return points;
}

TEST(DeformationTransfer, TheSameMeshDeformsAsTheSource) {
  const Surface surface = sheet(9, 7);
  const auto deformed = bent(surface);
  const std::uint32_t held[] = {0};
  const auto solver = DeformationTransfer::create(surface, all_pairs(surface), held);
  ASSERT_TRUE(solver.has_value());
  const auto shape = solver->transfer(deformation_gradients(surface, deformed));
  const Point3 shift = surface.points[0] - deformed[0];
  for (std::size_t v = 0; v < deformed.size(); ++v)
    EXPECT_NEAR(norm(shape.points[v] - (deformed[v] + shift)), 0, 1e-9);
  EXPECT_NEAR(shape.energy, 0, 1e-15);
  const auto still = solver->transfer(deformation_gradients(surface, surface.points));
  for (std::size_t v = 0; v < deformed.size(); ++v)
    EXPECT_NEAR(norm(still.points[v] - surface.points[v]), 0, 1e-12);
}

TEST(DeformationTransfer, ATargetOfAnotherSizeKeepsItsProportions) {
  const Surface source = sheet(9, 7), target = sheet(9, 7, 3.0);
  const auto deformed = bent(source);
  const auto solver = DeformationTransfer::create(target, all_pairs(source), {});
  const auto shape = solver->transfer(deformation_gradients(source, deformed));
  for (std::size_t v = 0; v < deformed.size(); ++v)
    EXPECT_NEAR(norm((shape.points[v] - shape.points[0]) - 3.0 * (deformed[v] - deformed[0])), 0, 1e-9);
}

TEST(DeformationTransfer, PartsWithoutPartnersAndHeldVerticesStayInPlace) {
  Surface two = sheet(4, 4);
  const Surface other = sheet(3, 3);
  for (const Point3& p : other.points) two.points.push_back(p + Point3{5, 0, 0});
  for (const Triangle& t : other.triangles) two.triangles.push_back({t[0] + 16, t[1] + 16, t[2] + 16});
  two.points.push_back({9, 9, 9});        // a vertex of no triangle
  two.triangles.push_back({16, 16, 17});  // and a triangle without area
  const std::uint32_t held[] = {3};
  const auto solver = DeformationTransfer::create(two, {}, held);
  ASSERT_TRUE(solver.has_value());
  const auto shape = solver->transfer({});
  for (std::size_t v = 0; v < two.points.size(); ++v)
    EXPECT_NEAR(norm(shape.points[v] - two.points[v]), 0, 1e-12);
}

TEST(DeformationTransfer, AnchorsSayWhereASurfaceIs) {
  const Surface surface = sheet(5, 5);
  const auto solver = DeformationTransfer::create(surface, all_pairs(surface), {}, {{7, 1.0}, {12, 1.0}});
  ASSERT_TRUE(solver.has_value());
  const Point3 shift = {0.5, -1, 2};
  const std::vector<Point3> places = {surface.points[7] + shift, surface.points[12] + shift};
  const auto shape = solver->transfer(deformation_gradients(surface, surface.points), places);
  for (std::size_t v = 0; v < surface.points.size(); ++v)
    EXPECT_NEAR(norm(shape.points[v] - (surface.points[v] + shift)), 0, 1e-10);
}

TEST(DeformationTransfer, TiedPiecesDeformAsOne) {
  const Surface whole = sheet(9, 7), cut = cut_along(whole, 9, 4);
  auto wanted = deformation_gradients(whole, bent(whole));
  // Nothing deforms like this, so that every piece alone would go its own way.
  for (std::size_t t = 0; t < wanted.size(); t += 3) wanted[t][0][1] += 0.4;
  const std::uint32_t held[] = {0};
  const auto one = DeformationTransfer::create(whole, all_pairs(whole), held);
  const auto two = DeformationTransfer::create(cut, all_pairs(cut), held, {}, touching_vertices(cut));
  const auto parted = DeformationTransfer::create(cut, all_pairs(cut), held);
  ASSERT_TRUE(one && two && parted);
  const auto shape = one->transfer(wanted), tied = two->transfer(wanted), loose = parted->transfer(wanted);
  double most = 0;
  for (std::size_t v = 0; v < whole.points.size(); ++v)
    EXPECT_NEAR(norm(tied.points[v] - shape.points[v]), 0, 1e-3) << v;
  for (std::size_t j = 0; j < 7; ++j) {
    EXPECT_NEAR(norm(tied.points[63 + j] - tied.points[9 * j + 4]), 0, 1e-4) << j;
    most = std::max(most, norm(loose.points[63 + j] - loose.points[9 * j + 4]));
  }
  EXPECT_GT(most, 0.05) << "without ties the cut opens";
  // At rest it stays at rest, also where copies are not quite at one place and where one of them is held.
  Surface apart = cut;
  for (std::size_t v = 63; v < apart.points.size(); ++v) apart.points[v][1] += 1e-3;
  const std::uint32_t on_the_cut[] = {63, 4};
  const auto still =
      DeformationTransfer::create(apart, all_pairs(apart), on_the_cut, {}, touching_vertices(apart));
  ASSERT_TRUE(still);
  const auto rest = still->transfer(deformation_gradients(apart, apart.points));
  for (std::size_t v = 0; v < apart.points.size(); ++v)
    EXPECT_NEAR(norm(rest.points[v] - apart.points[v]), 0, 1e-9);
}

TEST(DeformationGradients, AreTheMapWithinAndTheNormalAcross) {
  const Surface one{{{0, 0, 0}, {2, 0, 0}, {0, 3, 0}}, {{0, 1, 2}}};
  const std::vector<Point3> turned = {{1, 1, 1}, {1, 1, 5}, {1, 7, 1}};  // x -> 2 z, y -> 2 y, z -> -x
  const Matrix3 s = deformation_gradients(one, turned).front();
  EXPECT_NEAR(norm(s * Point3{1, 0, 0} - Point3{0, 0, 2}), 0, 1e-12);
  EXPECT_NEAR(norm(s * Point3{0, 1, 0} - Point3{0, 2, 0}), 0, 1e-12);
  EXPECT_NEAR(norm(s * Point3{0, 0, 1} - Point3{-1, 0, 0}), 0, 1e-12);
  const Surface flat{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}}};
  EXPECT_EQ(deformation_gradients(flat, flat.points).front(), kIdentity);
}

}  // namespace
}  // namespace mien
