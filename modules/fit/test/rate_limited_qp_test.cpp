#include "mien/fit/rate_limited_qp.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

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
    EXPECT_LE(solution->stationarity, 1e-10);
    EXPECT_LE(solution->complementarity, 1e-10);
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
