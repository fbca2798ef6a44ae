#include "mien/fit/rate_limited_qp.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "../src/active_set.h"
#include "../src/interior_point.h"
#include "mien/base/random.h"

namespace mien {
namespace {

struct Problem {
  std::int64_t k, t;
  std::vector<double> p, q;
  [[nodiscard]] RateLimitedQp view(double max_change) const {
    return {.num_channels = k, .quadratic = p, .linear = q, .max_change = max_change};
  }
};

// Shapes [10 k, k] of random numbers, followed by targets that leave the box and jump.
Problem random_problem(std::int64_t k, std::int64_t t, std::uint64_t seed) {
  Rng rng(seed);
  const std::int64_t rows = 10 * k;
  std::vector<double> b(static_cast<std::size_t>(rows * k));
  for (double& v : b) v = 0.01 * rng.normal();
  Problem problem{k, t, std::vector<double>(static_cast<std::size_t>(k * k)),
                  std::vector<double>(static_cast<std::size_t>(t * k))};
  for (std::int64_t i = 0; i < k; ++i)
    for (std::int64_t j = 0; j < k; ++j)
      for (std::int64_t m = 0; m < rows; ++m) problem.p[i * k + j] += b[m * k + i] * b[m * k + j];
  std::vector<double> wanted(static_cast<std::size_t>(k), 0.4);
  for (std::int64_t n = 0; n < t; ++n) {
    for (double& v : wanted) v = 0.8 * v + 0.2 * rng.normal(0.4, 1.2);
    for (std::int64_t i = 0; i < k; ++i)
      for (std::int64_t j = 0; j < k; ++j)
        problem.q[n * k + i] -= problem.p[i * k + j] * wanted[static_cast<std::size_t>(j)];
  }
  return problem;
}

double objective(const Problem& problem, const std::vector<double>& u) {
  double sum = 0;
  for (std::int64_t n = 0; n < problem.t; ++n)
    for (std::int64_t i = 0; i < problem.k; ++i) {
      const double ui = u[n * problem.k + i];
      sum += problem.q[n * problem.k + i] * ui;
      for (std::int64_t j = 0; j < problem.k; ++j)
        sum += 0.5 * ui * problem.p[i * problem.k + j] * u[n * problem.k + j];
    }
  return sum;
}

TEST(RateLimitedQp, KeepsEveryLimitAndNoFeasibleStepImprovesIt) {
  for (const std::int64_t t : {1, 2, 3, 60}) {
    const Problem problem = random_problem(6, t, 7 + static_cast<std::uint64_t>(t));
    Progress progress;
    const auto solution = solve(problem.view(0.1), progress);
    ASSERT_TRUE(solution.has_value());
    const auto& u = solution->curves;
    EXPECT_LE(solution->stationarity, 1e-13);
    EXPECT_LE(solution->complementarity, 1e-13);
    for (std::size_t i = 0; i < u.size(); ++i) {
      EXPECT_TRUE(u[i] >= 0 && u[i] <= 1);
      const double before = i < 6 ? u[i] : u[i - 6];
      EXPECT_LE(std::abs(u[i] - before), 0.1 + 1e-12);
    }
    // Towards any other feasible point the objective rises.
    const double best = objective(problem, u);
    Rng rng(3);
    for (int trial = 0; trial < 50; ++trial) {
      std::vector<double> other(u.size());
      double level = rng.uniform();
      for (std::size_t i = 0; i < other.size(); ++i) {
        if (i % 6 == 0) level = std::clamp(level + rng.uniform(-0.05, 0.05), 0.0, 1.0);
        other[i] = level;
      }
      auto moved = u;
      for (std::size_t i = 0; i < u.size(); ++i) moved[i] += 1e-3 * (other[i] - u[i]);
      EXPECT_GE(objective(problem, moved), best - 1e-15);
    }
  }
}

TEST(RateLimitedQp, WithoutARateLimitEveryFrameIsAlone) {
  const Problem all = random_problem(4, 5, 11);
  Progress progress;
  const auto together = solve(all.view(INFINITY), progress);
  ASSERT_TRUE(together.has_value());
  for (std::int64_t n = 0; n < all.t; ++n) {
    Problem one = all;
    one.t = 1;
    one.q.assign(all.q.begin() + n * 4, all.q.begin() + n * 4 + 4);
    const auto alone = solve(one.view(0.1), progress);
    ASSERT_TRUE(alone.has_value());
    for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(together->curves[n * 4 + i], alone->curves[i], 1e-8);
  }
}

// Both solvers on all frames at once.
std::vector<double> solve_whole(const RateLimitedQp& problem) {
  const ScaledQp scaled(problem);
  FrameChain chain(scaled.quadratic, scaled.num_channels, scaled.num_frames);
  InteriorPoint point(scaled, chain);
  while (point.complementarity() > 1e-8)
    if (!point.iterate()) return {};
  PolishedPoint polished;
  return polish(scaled, chain, point.x(), point.multipliers(), polished) ? polished.x : std::vector<double>();
}

TEST(RateLimitedQp, WindowsOfALongSequenceJoinToTheOptimumOfTheWhole) {
  const Problem problem = random_problem(4, 5000, 17);
  Progress progress;
  const auto solution = solve(problem.view(0.02), progress);
  ASSERT_TRUE(solution.has_value());
  const auto whole = solve_whole(problem.view(0.02));
  ASSERT_EQ(whole.size(), solution->curves.size());
  for (std::size_t i = 0; i < whole.size(); ++i) ASSERT_NEAR(solution->curves[i], whole[i], 1e-10) << i;
}

// Against a narrow limit one step of the target becomes a slope longer than what windows share, which then
// have to be solved together.
TEST(RateLimitedQp, LimitsThatReachAcrossWindowsAreSolvedTogether) {
  constexpr double kChange = 0.6 / 1500;
  Problem problem{1, 5000, {1}, std::vector<double>(5000)};
  for (std::size_t n = 0; n < 5000; ++n) problem.q[n] = n < 1900 || n > 4200 ? -0.2 : -0.8;
  Progress progress;
  const auto solution = solve(problem.view(kChange), progress);
  ASSERT_TRUE(solution.has_value());
  const auto whole = solve_whole(problem.view(kChange));
  ASSERT_EQ(whole.size(), solution->curves.size());
  for (std::size_t i = 0; i < whole.size(); ++i) ASSERT_NEAR(solution->curves[i], whole[i], 1e-9) << i;
  EXPECT_NEAR(solution->curves[1900] - solution->curves[1899], kChange, 1e-12);
}

TEST(RateLimitedQp, MoreLimitsThanValuesHoldAtOnce) {
  // From 0 to 1 in ten frames at the limit: both ends of the box and all ten changes hold.
  Problem problem{1, 30, {1}, std::vector<double>(30)};
  for (std::size_t n = 0; n < 30; ++n) problem.q[n] = n < 15 ? 50 : -50;
  Progress progress;
  const auto solution = solve(problem.view(0.1), progress);
  ASSERT_TRUE(solution.has_value());
  for (std::size_t n = 0; n < 30; ++n)
    EXPECT_NEAR(solution->curves[n], std::clamp(0.1 * (static_cast<double>(n) - 9.5), 0.0, 1.0), 0.0501) << n;
  EXPECT_LT(solution->stationarity, 1e-8);
}

TEST(RateLimitedQp, NoFramesAndNoChannels) {
  Progress progress;
  const std::vector<double> p = {1};
  EXPECT_TRUE(solve({.num_channels = 1, .quadratic = p, .linear = {}}, progress)->curves.empty());
  EXPECT_TRUE(solve({.num_channels = 0, .quadratic = {}, .linear = {}}, progress)->curves.empty());
}

TEST(RateLimitedQp, RefusesWhatHasNoOneSolution) {
  Progress progress;
  const std::vector<double> q = {1, 1}, zero = {0, 0, 0, 0}, nan = {1, 0, 0, std::nan("")};
  EXPECT_EQ(solve({.num_channels = 2, .quadratic = zero, .linear = q}, progress).error().code, Errc::input);
  EXPECT_EQ(solve({.num_channels = 2, .quadratic = nan, .linear = q}, progress).error().code, Errc::input);
  progress.cancel();
  const std::vector<double> p = {1, 0, 0, 1};
  EXPECT_EQ(solve({.num_channels = 2, .quadratic = p, .linear = q}, progress).error().code, Errc::cancelled);
}

}  // namespace
}  // namespace mien
