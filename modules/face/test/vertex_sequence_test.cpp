#include "mien/face/vertex_sequence.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "mien/base/random.h"
#include "mien/face/vertex_basis.h"

namespace mien {
namespace {

// Three vertices on parts of their own, one shape that lifts the last.
Character two_parts() {
  Character character;
  character.name = "pair";
  character.parts.push_back({"skin", {{{0, 0, 0}, {1, 0, 0}}, {}, {}, {}}, {}});
  character.parts.push_back({"teeth", {{{0, 1, 0}}, {}, {}, {}}, {{"jawOpen", {0}, {{0, -2, 0}}, {}}}});
  return character;
}

// N frames of V vertices: `rank` waves of their own shape, and noise.
Motion waves(std::int64_t num_frames, std::int64_t num_vertices, int rank, float noise) {
  Motion motion = vertex_motion({"waves", num_vertices}, 25);
  Rng rng(3);
  std::vector<float> shapes(static_cast<std::size_t>(rank * 3 * num_vertices));
  for (float& x : shapes) x = static_cast<float>(rng.normal());
  for (std::int64_t n = 0; n < num_frames; ++n)
    for (std::int64_t c = 0; c < 3 * num_vertices; ++c) {
      double x = static_cast<double>(c % 7);
      for (int k = 0; k < rank; ++k)
        x += std::sin(0.1 * static_cast<double>((k + 1) * n) + k) *
             static_cast<double>(shapes[static_cast<std::size_t>(k * 3 * num_vertices + c)]);
      motion.values.push_back(static_cast<float>(x + static_cast<double>(noise) * rng.normal()));
    }
  return motion;
}

double farthest(const Motion& motion, const VertexBasis& basis) {
  double worst = 0;
  std::vector<Vec3> posed(basis.neutral.size()), truth(basis.neutral.size());
  for (std::int64_t n = 0; n < motion.num_frames(); ++n) {
    evaluate_blendshapes(basis.neutral, basis.shapes, basis.coefficients.frame(n), posed);
    copy_positions(motion, n, truth);
    for (std::size_t v = 0; v < posed.size(); ++v)
      worst = std::max(worst, static_cast<double>(length(posed[v] - truth[v])));
  }
  return worst;
}

TEST(VertexSequence, HoldsAllPartsInTheirOrder) {
  const Motion curves{MotionSpace::arkit, {"jawOpen"}, 30, {0, 0.5f}};
  const auto motion = vertex_sequence(two_parts(), curves, 2);
  ASSERT_TRUE(motion) << motion.error().message();
  EXPECT_EQ(motion->topology, (Topology{"pair", 3}));
  EXPECT_EQ(motion->fps, 30);
  EXPECT_EQ(motion->values, (std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0}));
  PosedCharacter posed;
  pose_vertices(two_parts(), motion->frame(1), posed);
  EXPECT_EQ(posed[1].positions[0], (Vec3{0, 0, 0}));
}

TEST(VertexSequence, OfSomethingElseIsAnError) {
  const Motion vertices = vertex_motion({"", 3}, 30);
  EXPECT_EQ(vertex_sequence(two_parts(), vertices).error().code, Errc::incompatible);
  const Motion stranger{MotionSpace::rig, {"wing"}, 30, {1}};
  EXPECT_EQ(vertex_sequence(two_parts(), stranger).error().code, Errc::incompatible);
  const Motion none{MotionSpace::arkit, {"jawOpen"}, 30, {}};
  EXPECT_EQ(vertex_sequence(two_parts(), none)->num_frames(), 0);
}

TEST(LengthScale, IsGivenKnownOrAConvention) {
  const Motion motion = vertex_motion({"", 2}, 30, {0, 0, 0, 0, 2, 1});
  EXPECT_DOUBLE_EQ(length_scale(motion).mm_per_unit, kHeadExtentMm / 2);
  EXPECT_DOUBLE_EQ(length_scale(motion, 3).mm_per_unit, 3);
  const Motion flame = vertex_motion(topology_of(5023), 30, std::vector<float>(3 * 5023));
  EXPECT_DOUBLE_EQ(length_scale(flame).mm_per_unit, 1000);
  EXPECT_DOUBLE_EQ(length_scale(vertex_motion({"", 2}, 30)).mm_per_unit, 1);
}

TEST(VertexStage, IsInMetresAndUpright) {
  const Motion motion = vertex_motion({"", 2}, 30, {1, 2, 3, 4, 5, 6});
  const Mesh mesh{{{}, {}}, {{0, 1, 1}}, {}, {}};
  const auto stage = stage_vertices(motion, mesh, {500, ""}, DataAxes::inverted);
  ASSERT_TRUE(stage);
  EXPECT_EQ(stage->motion.values, (std::vector<float>{0.5f, -1, -1.5f, 2, -2.5f, -3}));
  EXPECT_EQ(stage->character.parts[0].mesh.positions[1], (Vec3{2, -2.5f, -3}));
  EXPECT_EQ(stage_vertices(motion, mesh, {500, ""}, DataAxes::upright)->motion.values[1], 1);
  EXPECT_EQ(stage_vertices(motion, Mesh{}, {1, ""}, DataAxes::upright).error().code, Errc::incompatible);
  const Motion none = vertex_motion({"", 2}, 30);
  EXPECT_EQ(stage_vertices(none, mesh, {1, ""}, DataAxes::upright).error().code, Errc::input);
}

TEST(VertexBasis, FindsTheFewShapesOfASimpleMotion) {
  const Motion motion = waves(60, 40, 4, 0);
  Progress progress;
  const auto basis = vertex_basis(motion, {.max_error = 1e-3}, progress);
  ASSERT_TRUE(basis) << basis.error().message();
  EXPECT_EQ(basis->shapes.size(), 4u);
  EXPECT_LE(basis->max_error, 1e-3);
  EXPECT_NEAR(farthest(motion, *basis), basis->max_error, 1e-5);
  EXPECT_LT(basis->rms_error, basis->max_error);
  for (const float c : basis->coefficients.values) EXPECT_LE(std::abs(c), 1.0f);
  EXPECT_EQ(basis->coefficients.channels[1], "shape001");
  EXPECT_EQ(basis->coefficients.num_frames(), 60);
}

TEST(VertexBasis, KeepsEveryErrorThatIsAskedFor) {
  const Motion motion = waves(400, 20, 3, 0.01f);  // more frames than are sampled, none like another
  Progress progress;
  std::size_t last = 1000;
  for (const double error : {1e-3, 0.02, 0.05, 1.0}) {
    const auto basis = vertex_basis(motion, {.max_error = error}, progress);
    ASSERT_TRUE(basis);
    EXPECT_LE(basis->max_error, error);
    EXPECT_LE(basis->shapes.size(), last);
    last = basis->shapes.size();
    EXPECT_TRUE(basis.warnings.empty());
  }
}

TEST(VertexBasis, SameForAnyNumberOfThreads) {
  const Motion motion = waves(50, 30, 3, 0.01f);
  Progress progress;
  const auto one = vertex_basis(motion, {.max_error = 0.02}, progress);
  for (const int threads : {2, 7}) {
    const auto other = vertex_basis(motion, {.max_error = 0.02, .num_threads = threads}, progress);
    EXPECT_EQ(other->coefficients.values, one->coefficients.values);
    EXPECT_EQ(other->max_error, one->max_error);
  }
}

TEST(VertexBasis, TooFewShapesAreAWarningWithTheRealError) {
  const Motion motion = waves(60, 40, 4, 0);
  Progress progress;
  const auto basis = vertex_basis(motion, {.max_error = 1e-3, .max_shapes = 2}, progress);
  ASSERT_TRUE(basis);
  EXPECT_EQ(basis->shapes.size(), 2u);
  EXPECT_GT(basis->max_error, 1e-3);
  EXPECT_NEAR(farthest(motion, *basis), basis->max_error, 1e-5);
  EXPECT_EQ(basis.warnings.size(), 1u);
}

TEST(VertexBasis, StillAndSingleFramesAndBrokenNumbers) {
  Progress progress;
  const VertexBasisOptions options{.max_error = 1e-3};
  const Motion single = vertex_motion({"", 2}, 30, {1, 2, 3, 4, 5, 6});
  const auto basis = vertex_basis(single, options, progress);
  ASSERT_TRUE(basis);
  EXPECT_EQ(basis->shapes.size(), 1u);
  EXPECT_EQ(basis->neutral[1], (Vec3{4, 5, 6}));
  EXPECT_EQ(basis->max_error, 0);
  Motion broken = single;
  broken.values[4] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(vertex_basis(broken, options, progress).error().code, Errc::input);
  EXPECT_EQ(vertex_basis(vertex_motion({"", 2}, 30), options, progress).error().code, Errc::input);
  Progress stopped;
  stopped.cancel();
  EXPECT_EQ(vertex_basis(waves(20, 5, 3, 0.1f), options, stopped).error().code, Errc::cancelled);
}

}  // namespace
}  // namespace mien
