#include "mien/fit/coefficient_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "mien/base/random.h"

namespace mien {
namespace {

struct Rig {
  std::vector<Vec3> neutral;
  std::vector<Blendshape> shapes;
};

Rig random_rig(std::size_t num_vertices, int num_shapes) {
  Rng rng(5);
  Rig rig;
  const auto number = [&](double sd) { return static_cast<float>(rng.normal(0, sd)); };
  for (std::size_t v = 0; v < num_vertices; ++v)
    rig.neutral.push_back({number(0.1), number(0.1), number(0.1)});
  for (int k = 0; k < num_shapes; ++k) {
    Blendshape shape{"shape" + std::to_string(k), {}, {}, {}};
    for (std::uint32_t v = 0; v < num_vertices; ++v)
      if (rng.chance(0.4)) {
        shape.vertices.push_back(v);
        shape.offsets.push_back({number(0.01), number(0.01), number(0.01)});
      }
    rig.shapes.push_back(shape);
  }
  return rig;
}

Motion perform(const Rig& rig, std::span<const float> curves) {
  const std::size_t k = rig.shapes.size();
  std::vector<float> values;
  for (std::size_t n = 0; n * k < curves.size(); ++n) {
    std::vector<Vec3> frame(rig.neutral.size());
    evaluate_blendshapes(rig.neutral, rig.shapes, curves.subspan(n * k, k), frame);
    for (const Vec3& p : frame) values.insert(values.end(), {p.x, p.y, p.z});
  }
  return vertex_motion({"test", static_cast<std::int64_t>(rig.neutral.size())}, 60, values);
}

TEST(CoefficientFit, FindsTheCurvesThatMadeTheSequence) {
  const Rig rig = random_rig(60, 8);
  std::vector<float> curves;
  for (int n = 0; n < 40; ++n)
    for (int k = 0; k < 8; ++k) curves.push_back(static_cast<float>(0.5 + 0.45 * std::sin(0.1 * n + k)));
  Progress progress;
  const FitRegions regions = {{"some", {1, 2, 3}}};
  const auto fit = fit_coefficients(rig.neutral, rig.shapes, perform(rig, curves), regions, {}, progress);
  ASSERT_TRUE(fit.has_value());
  EXPECT_EQ(fit->coefficients.channels[3], "shape3");
  ASSERT_EQ(fit->coefficients.values.size(), curves.size());
  for (std::size_t i = 0; i < curves.size(); ++i) EXPECT_NEAR(fit->coefficients.values[i], curves[i], 1e-4);
  for (const double r : fit->residual) EXPECT_LT(r, 1e-6);
  EXPECT_EQ(fit->region_residual.at("some").size(), 40u);

  FitOptions threads;
  threads.num_threads = 3;
  const auto again =
      fit_coefficients(rig.neutral, rig.shapes, perform(rig, curves), regions, threads, progress);
  EXPECT_EQ(again->coefficients.values, fit->coefficients.values);
}

TEST(CoefficientFit, ReportsWhatTheLimitsLeaveOver) {
  const Rig rig = random_rig(60, 3);
  const std::vector<float> curves = {0, 0, 0, 1, 0, 0};  // a jump in one frame
  Progress progress;
  const auto fit = fit_coefficients(rig.neutral, rig.shapes, perform(rig, curves), {}, {}, progress);
  ASSERT_TRUE(fit.has_value());
  EXPECT_NEAR(fit->coefficients.values[3] - fit->coefficients.values[0], 0.1, 1e-6);
  EXPECT_GT(fit->residual[1], 1e-3);
}

TEST(CoefficientFit, StaysBetweenZeroAndOneAtTheRateOfTheSequence) {
  const Rig rig = random_rig(60, 3);
  const std::vector<float> curves = {1.4f, -0.3f, 0.5f, 1.4f, -0.3f, 0.5f};
  Motion sequence = perform(rig, curves);
  sequence.fps = 25;
  Progress progress;
  const auto fit = fit_coefficients(rig.neutral, rig.shapes, sequence, {}, {}, progress);
  ASSERT_TRUE(fit.has_value());
  EXPECT_EQ(fit->coefficients.fps, 25);
  for (std::size_t i = 0; i < curves.size(); i += 3) {
    EXPECT_NEAR(fit->coefficients.values[i], 1, 1e-6);
    EXPECT_NEAR(fit->coefficients.values[i + 1], 0, 1e-6);
  }
}

TEST(CoefficientFit, ResidualsAreRootMeanSquaresOfTheirVertices) {
  Rig rig = random_rig(60, 1);
  rig.shapes = {{"shape", {0}, {{0.01f, 0, 0}}, {}}};
  const std::vector<float> curves = {0};
  Motion sequence = perform(rig, curves);
  sequence.values[3 * 5] += 0.003f;  // what no shape moves
  sequence.values[3 * 6] += 0.004f;
  Progress progress;
  const FitRegions regions = {{"both", {5, 6}}, {"one", {6}}};
  const auto fit = fit_coefficients(rig.neutral, rig.shapes, sequence, regions, {}, progress);
  ASSERT_TRUE(fit.has_value());
  EXPECT_NEAR(fit->residual[0], 0.005 / std::sqrt(60.0), 1e-7);
  EXPECT_NEAR(fit->region_residual.at("both")[0], 0.005 / std::sqrt(2.0), 1e-7);
  EXPECT_NEAR(fit->region_residual.at("one")[0], 0.004, 1e-7);
}

TEST(CoefficientFit, RefusesOtherMeshesAndNumbers) {
  const Rig rig = random_rig(20, 2);
  Progress progress;
  Motion other = vertex_motion({"", 21}, 60, std::vector<float>(63, 0.0f));
  EXPECT_EQ(fit_coefficients(rig.neutral, rig.shapes, other, {}, {}, progress).error().code,
            Errc::incompatible);
  Motion nan = vertex_motion({"", 20}, 60, std::vector<float>(60, NAN));
  EXPECT_EQ(fit_coefficients(rig.neutral, rig.shapes, nan, {}, {}, progress).error().code, Errc::input);
  const Motion none = vertex_motion({"", 20}, 60);
  EXPECT_EQ(fit_coefficients(rig.neutral, rig.shapes, none, {}, {}, progress)->coefficients.num_frames(), 0);
}

}  // namespace
}  // namespace mien
