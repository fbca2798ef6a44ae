// The coefficient problem of `mien fit`: 32 channels whose targets leave the box and move faster than
// allowed. cpu time: one thread.
#include <benchmark/benchmark.h>

#include <cmath>
#include <vector>

#include "mien/base/random.h"
#include "mien/fit/rate_limited_qp.h"

namespace mien {
namespace {

constexpr std::int64_t kChannels = 32;

struct Problem {
  std::vector<double> quadratic, linear;
};

// Shapes of random numbers; targets that wander (random) or swing (smooth).
Problem make_problem(std::int64_t num_frames, bool is_smooth) {
  Rng rng(7);
  const std::int64_t k = kChannels, rows = 10 * k;
  std::vector<double> shapes(static_cast<std::size_t>(rows * k));
  for (double& v : shapes) v = 0.01 * rng.normal();
  Problem problem{std::vector<double>(static_cast<std::size_t>(k * k)),
                  std::vector<double>(static_cast<std::size_t>(num_frames * k))};
  for (std::int64_t i = 0; i < k; ++i)
    for (std::int64_t j = 0; j < k; ++j)
      for (std::int64_t m = 0; m < rows; ++m)
        problem.quadratic[i * k + j] += shapes[m * k + i] * shapes[m * k + j];
  std::vector<double> target(static_cast<std::size_t>(k), 0.4);
  for (std::int64_t n = 0; n < num_frames; ++n)
    for (std::int64_t i = 0; i < k; ++i) {
      double& t = target[static_cast<std::size_t>(i)];
      const auto frame = static_cast<double>(n), channel = static_cast<double>(i);
      t = is_smooth ? 0.35 + 0.45 * std::sin(channel + frame * (0.05 + 0.01 * channel)) + 0.03 * rng.normal()
                    : 0.8 * t + 0.2 * rng.normal(0.4, 1.2);
      for (std::int64_t j = 0; j < k; ++j) problem.linear[n * k + j] -= problem.quadratic[i * k + j] * t;
    }
  return problem;
}

void fit_curves(benchmark::State& state) {
  const Problem problem = make_problem(state.range(0), state.range(1) != 0);
  Progress progress;
  QpSolution last;
  for (auto _ : state) {
    auto solution = solve(
        {.num_channels = kChannels, .quadratic = problem.quadratic, .linear = problem.linear}, progress);
    if (!solution) {
      state.SkipWithError(solution.error().message().c_str());
      break;
    }
    last = *std::move(solution);
  }
  state.counters["iterations"] = last.num_iterations;
  state.counters["gradient"] = last.stationarity;
  state.counters["complementarity"] = last.complementarity;
}
BENCHMARK(fit_curves)
    ->ArgNames({"frames", "smooth"})
    ->Args({240, 1})
    ->Args({240, 0})
    ->Args({2400, 0})
    ->Args({24000, 0})
    ->Args({216000, 0})
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace mien
