#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "mien/base/random.h"
#include "mien/core/rig_controls.h"
#include "mien/metrics/control_error.h"
#include "mien/metrics/surface_distance.h"
#include "mien/metrics/vertex_error.h"
#include "mien/metrics/vertex_regions.h"
#include "mien/metrics/vertex_travel.h"

namespace mien {
namespace {

using Triangle = TriangleTree::Triangle;

Motion pair_motion(std::vector<float> values) { return vertex_motion({"pair", 2}, 25, std::move(values)); }

TEST(VertexError, HasTheValuesOfASumByHand) {
  // Vertex 0 is off by 3 in the first frame and right in the second; vertex 1 is off by 4 and by 5.
  const Motion truth = pair_motion({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
  const Motion predicted = pair_motion({3, 0, 0, 0, 4, 0, 0, 0, 0, 3, 4, 0});
  const std::vector<float> neutral(6, 0);
  VertexErrors errors({{1}, {0, 1}});
  ASSERT_TRUE(errors.add("a", truth, predicted, neutral));
  EXPECT_DOUBLE_EQ(errors.mve(), (3 + 4 + 0 + 5) / 4.0);
  EXPECT_DOUBLE_EQ(errors.lve(), (16 + 25) / 2.0);
  // Squared distances from the neutral: vertex 0: 9, 0 (std 4.5); vertex 1: 16, 25 (std 4.5); the truth never
  // moves.
  EXPECT_DOUBLE_EQ(errors.fdd(), -4.5);
  EXPECT_DOUBLE_EQ(errors.absolute_fdd(), 4.5);
  // A second, perfect sequence: MVE and LVE pool frames, FDD sequences.
  ASSERT_TRUE(errors.add("b", truth, truth, neutral));
  EXPECT_DOUBLE_EQ(errors.mve(), 12 / 8.0);
  EXPECT_DOUBLE_EQ(errors.lve(), 41 / 4.0);
  EXPECT_DOUBLE_EQ(errors.fdd(), -2.25);
  EXPECT_EQ(errors.num_frames(), 4);
}

TEST(VertexError, CutsToTheCommonLengthAndSaysWhatIsNotDefined) {
  const Motion one = pair_motion({1, 0, 0, 0, 0, 0}), two = pair_motion({0, 0, 0, 0, 0, 0, 9, 9, 9, 9, 9, 9});
  VertexErrors errors({{}, {0}});
  ASSERT_TRUE(errors.add("short", two, one, {}));
  EXPECT_EQ(errors.num_frames(), 1);
  EXPECT_DOUBLE_EQ(errors.mve(), 0.5);
  EXPECT_TRUE(std::isnan(errors.lve()));
  EXPECT_TRUE(std::isnan(errors.fdd()));
  EXPECT_TRUE(std::isnan(VertexErrors({{0}, {0}}).mve()));
  ASSERT_TRUE(errors.add("empty", pair_motion({}), one, {}));
  EXPECT_EQ(errors.num_frames(), 1);
}

TEST(VertexError, RefusesWhatDoesNotFit) {
  const Motion motion = pair_motion({1, 0, 0, 0, 0, 0});
  const Motion other = vertex_motion({"one", 1}, 25, {0, 0, 0});
  const Motion curves{MotionSpace::arkit, {"jawOpen"}, 25, {0}};
  EXPECT_EQ(VertexErrors({}).add("a", motion, other, {}).error().code, Errc::incompatible);
  EXPECT_EQ(VertexErrors({}).add("a", curves, curves, {}).error().code, Errc::incompatible);
  EXPECT_EQ(VertexErrors({}).add("a", motion, motion, std::vector<float>(3)).error().code,
            Errc::incompatible);
  EXPECT_EQ(VertexErrors({{2}, {}}).add("a", motion, motion, {}).error().code, Errc::incompatible);
}

TEST(TakeDiversity, IsTheMeanOverUnorderedPairs) {
  std::vector<Motion> takes = {pair_motion({0, 0, 0, 0, 0, 0}), pair_motion({1, 0, 0, 0, 0, 0}),
                               pair_motion({3, 0, 0, 0, 0, 0, 5, 5, 5, 5, 5, 5})};
  EXPECT_DOUBLE_EQ(take_diversity(takes), (0.5 + 1.5 + 1.0) / 3);
  EXPECT_TRUE(std::isnan(take_diversity(std::span(takes).first(1))));
  takes.push_back(pair_motion({}));
  EXPECT_TRUE(std::isnan(take_diversity(takes)));
}

TEST(ControlError, HasTheValuesOfASumByHand) {
  const auto motion = [](std::vector<float> values) {
    return Motion{MotionSpace::rig, {"a", "b", "c"}, 30, std::move(values)};
  };
  const Motion truth = motion({0, 0, 0, 0, 0, 2}), predicted = motion({3, 4, 0, 0, 0, 1});
  ControlErrors errors({{1}, {2}});
  ASSERT_TRUE(errors.add("a", truth, predicted));
  EXPECT_DOUBLE_EQ(errors.mce(), 3);          // lengths 5 and 1
  EXPECT_DOUBLE_EQ(errors.lce(), 2);          // 4 and 0
  EXPECT_DOUBLE_EQ(errors.fdd(), 2.0 - 0.5);  // squares 0, 4 against 0, 1
  ASSERT_TRUE(errors.add("b", predicted, truth));
  EXPECT_DOUBLE_EQ(errors.fdd(), 0);
  EXPECT_DOUBLE_EQ(errors.absolute_fdd(), 1.5);
  EXPECT_EQ(errors.add("c", truth, Motion{MotionSpace::rig, {"a"}, 30, {0}}).error().code,
            Errc::incompatible);
  EXPECT_TRUE(std::isnan(ControlErrors({}).mce()));
}

TEST(ControlError, KnowsTheRegionsOfTheDataSets) {
  ASSERT_TRUE(control_regions(51) && control_regions(192));
  EXPECT_EQ(control_regions(192)->upper.size(), 131u);
  EXPECT_EQ(control_regions(51)->mouth.size(), 12u);
  EXPECT_FALSE(control_regions(52));
}

TEST(VertexRegions, AreIndicesOrWeights) {
  EXPECT_EQ(read_region("2, 5,7\n9 11\r\n", 12, 0.1).value(), (std::vector<std::uint32_t>{2, 5, 7, 9, 11}));
  EXPECT_EQ(read_region("0.0\n0.05\n0.1\n0.4\n1\n", 5, 0.1).value(), (std::vector<std::uint32_t>{3, 4}));
  EXPECT_EQ(read_region("0 1 2", 3, 0.5).value().size(),
            3u);  // no dot: indices, although there are V of them
  EXPECT_TRUE(read_region("", 3, 0.1)->empty());
  EXPECT_EQ(read_region("1, x", 3, 0.1).error().code, Errc::input);
  EXPECT_EQ(read_region("3", 3, 0.1).error().code, Errc::incompatible);
  EXPECT_EQ(read_region("-1", 3, 0.1).error().code, Errc::incompatible);
  EXPECT_EQ(read_region("0.5 1.5", 3, 0.1).error().code, Errc::incompatible);
}

TEST(TriangleDistance, IsRightInEveryRegionAndForTrianglesWithoutArea) {
  const Vec3 a{0, 0, 0}, b{2, 0, 0}, c{0, 2, 0};
  EXPECT_DOUBLE_EQ(triangle_distance({0.5f, 0.5f, 3}, a, b, c), 3);  // inside
  EXPECT_DOUBLE_EQ(triangle_distance({-3, -4, 0}, a, b, c), 5);      // corners
  EXPECT_DOUBLE_EQ(triangle_distance({5, -4, 0}, a, b, c), 5);
  EXPECT_DOUBLE_EQ(triangle_distance({-4, 5, 0}, a, b, c), 5);
  EXPECT_DOUBLE_EQ(triangle_distance({1, -2, 0}, a, b, c), 2);  // edges
  EXPECT_DOUBLE_EQ(triangle_distance({-2, 1, 0}, a, b, c), 2);
  EXPECT_NEAR(triangle_distance({2, 2, 0}, a, b, c), std::sqrt(2.0), 1e-12);
  EXPECT_DOUBLE_EQ(triangle_distance({1, 3, 0}, a, a, b), 3);  // a segment, in every order
  EXPECT_DOUBLE_EQ(triangle_distance({1, 3, 0}, a, b, a), 3);
  EXPECT_DOUBLE_EQ(triangle_distance({1, 3, 0}, b, a, a), 3);
  EXPECT_DOUBLE_EQ(triangle_distance({3, 4, 0}, a, a, a), 5);  // a point
}

TEST(TriangleTree, EqualsBruteForceAlsoAfterMoving) {
  Rng rng(5);
  const auto point = [&] {
    return Vec3{static_cast<float>(rng.normal()), static_cast<float>(rng.normal()),
                static_cast<float>(rng.normal())};
  };
  std::vector<Vec3> positions(90);
  std::vector<Triangle> triangles(150);
  for (auto& t : triangles)
    for (auto& v : t) v = static_cast<std::uint32_t>(rng.below(positions.size()));
  for (auto& p : positions) p = point();
  TriangleTree tree(positions, triangles);
  for (int round = 0; round < 2; ++round) {
    for (int i = 0; i < 200; ++i) {
      const Vec3 p = 2 * point();
      double best = std::numeric_limits<double>::infinity();
      for (const auto& t : triangles)
        best = std::min(best, triangle_distance(p, positions[t[0]], positions[t[1]], positions[t[2]]));
      ASSERT_EQ(tree.distance(p), best) << "round " << round << " point " << i;
    }
    for (auto& p : positions) p = point();
    tree.move(positions);
  }
}

TEST(SurfaceDistance, IsZeroOnTheSurfaceAndTheSameForAnyNumberOfThreads) {
  Rng rng(9);
  Motion truth = vertex_motion({"", 30}, 25), predicted = truth;
  for (int i = 0; i < 20 * 90; ++i) truth.values.push_back(static_cast<float>(rng.normal()));
  for (const float x : truth.values) predicted.values.push_back(x + static_cast<float>(0.1 * rng.normal()));
  std::vector<Triangle> triangles;
  for (std::uint32_t v = 0; v + 2 < 30; ++v) triangles.push_back({v, v + 1, v + 2});
  EXPECT_NEAR(surface_distance(truth, truth, triangles).value(), 0, 1e-12);
  const double one = surface_distance(truth, predicted, triangles, 1).value();
  EXPECT_GT(one, 0.01);
  for (const int threads : {2, 7})
    EXPECT_EQ(surface_distance(truth, predicted, triangles, threads).value(), one);
  EXPECT_TRUE(std::isnan(surface_distance(vertex_motion({"", 30}, 25), predicted, triangles).value()));
  EXPECT_EQ(surface_distance(truth, predicted, {}).error().code, Errc::incompatible);
  EXPECT_EQ(surface_distance(truth, predicted, std::vector<Triangle>{{0, 1, 30}}).error().code,
            Errc::incompatible);
  EXPECT_EQ(surface_distance(truth, vertex_motion({"", 1}, 25), triangles).error().code, Errc::incompatible);
}

TEST(VertexTravel, HasTheValuesOfASumByHand) {
  // Vertex 0 goes 3, then 5; vertex 1 stays.
  const auto travel = vertex_travel(pair_motion({0, 0, 0, 1, 1, 1, 3, 0, 0, 1, 1, 1, 3, 3, 4, 1, 1, 1}));
  ASSERT_TRUE(travel);
  EXPECT_EQ(travel->mean, (std::vector<float>{4, 0}));
  EXPECT_EQ(travel->deviation, (std::vector<float>{1, 0}));
}

TEST(VertexTravel, NeedsTwoFramesOfVertices) {
  EXPECT_EQ(vertex_travel(pair_motion({})).error().code, Errc::input);
  EXPECT_EQ(vertex_travel(pair_motion({0, 0, 0, 1, 1, 1})).error().code, Errc::input);
  EXPECT_EQ(vertex_travel({MotionSpace::arkit, {"jawOpen"}, 60, {0, 1}}).error().code, Errc::incompatible);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto travel = vertex_travel(pair_motion({0, 0, 0, nan, 0, 0, 0, 0, 0, nan, 0, 0}));
  ASSERT_TRUE(travel);
  EXPECT_EQ(travel->mean[0], 0);
  EXPECT_TRUE(std::isnan(travel->mean[1]));
}

}  // namespace
}  // namespace mien
