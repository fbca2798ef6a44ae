#include "head/curves.h"

#include <gtest/gtest.h>

#include <array>
#include <stdexcept>

namespace mien::head {
namespace {

TEST(Curves, SmoothStepHoldsItsEndsInBothDirections) {
  EXPECT_EQ(smooth_step(1, 3, 0), 0);
  EXPECT_EQ(smooth_step(1, 3, 2), 0.5);
  EXPECT_EQ(smooth_step(1, 3, 9), 1);
  EXPECT_EQ(smooth_step(3, 1, 9), 0);
  EXPECT_EQ(smooth_step(3, 1, 0), 1);
}

TEST(Curves, NaturalSplineOfThreePointsInClosedForm) {
  // Through (0,0) (1,1) (2,0): M = (0, -3, 0), so the first piece is 1.5 t - 0.5 t^3.
  const NaturalSplines spline({0, 1, 2}, {{0, 1, 0}, {5, 5, 5}});
  std::array<double, 2> out{};
  for (const double t : {0.0, 0.25, 0.5, 1.0}) {
    spline.evaluate(t, out);
    EXPECT_NEAR(out[0], 1.5 * t - 0.5 * t * t * t, 1e-15);
    EXPECT_EQ(out[1], 5);
  }
  spline.evaluate(2, out);
  EXPECT_NEAR(out[0], 0, 1e-15);
  EXPECT_THROW(NaturalSplines({0, 1}, {{0, 1}}), std::logic_error);
  EXPECT_THROW(NaturalSplines({0, 1, 2}, {{0, 1}}), std::logic_error);
}

TEST(Curves, MonotoneCurveNeverOvershoots) {
  const std::vector<double> x = {0, 1, 1.5, 3, 4, 5}, y = {0, 0, 2, 2.1, 2.1, -1};
  const MonotoneCurve curve(x, y);
  for (std::size_t i = 0; i < x.size(); ++i) EXPECT_NEAR(curve(x[i]), y[i], 1e-14);
  for (std::size_t i = 0; i + 1 < x.size(); ++i)
    for (int k = 0; k <= 20; ++k) {
      const double value = curve(x[i] + k / 20.0 * (x[i + 1] - x[i]));
      EXPECT_GE(value, std::min(y[i], y[i + 1]) - 1e-12);
      EXPECT_LE(value, std::max(y[i], y[i + 1]) + 1e-12);
    }
}

TEST(Curves, InterpolateHoldsItsEnds) {
  const std::array x = {1.0, 2.0, 4.0}, y = {10.0, 20.0, 0.0};
  EXPECT_EQ(interpolate(-5, x, y), 10);
  EXPECT_EQ(interpolate(1.5, x, y), 15);
  EXPECT_EQ(interpolate(3, x, y), 10);
  EXPECT_EQ(interpolate(9, x, y), 0);
}

}  // namespace
}  // namespace mien::head
