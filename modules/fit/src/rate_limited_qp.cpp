#include "mien/fit/rate_limited_qp.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "active_set.h"
#include "frame_chain.h"
#include "interior_point.h"
#include "mien/base/contract.h"

namespace mien {
namespace {

constexpr int kMaxIterations = 80, kMaxStuck = 12;
// Relative to the mean diagonal of P: below this the sides of nearly all limits are known, and the active set
// method needs fewer rounds than the interior point method needs iterations to tell the last ones apart.
constexpr double kSidesKnown = 1e-5;
constexpr double kNextTry = 1e-2;  // how much closer the interior point comes before sides are tried again
// Without sides that settle: where a limit barely holds, slack and multiplier are both small and a curve is
// off by the root of their product, so complementarity must go far below the wanted error; the gradient then
// keeps a rounding error from multipliers that are known only that well.
constexpr double kComplementary = 1e-18, kStationary = 1e-8;
// Long sequences are solved in windows, so that memory does not grow with them. What happens at the end of a
// window fades within some tens of frames; kJoint is how well two windows must agree where they are joined.
constexpr std::int64_t kWindow = 2048, kOverlap = 256;
constexpr double kJoint = 1e-12;

Error not_definite() {
  return Error{Errc::input, "fit",
               "the shapes do not decide the coefficients: two of them move the face alike",
               "Leave out one of the shapes that are combinations of others, or shapes that move nothing"};
}

// The optimum of some frames, with what their ties carry.
struct Window {
  std::int64_t first = 0, end = 0;
  std::vector<double> curves;     // [end - first, K]
  std::vector<double> pair_pull;  // [end - first - 1, K], relative to the mean diagonal of P
  int num_iterations = 0;
  double stationarity = 0, complementarity = 0;
};

std::vector<double> difference(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> result(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) result[i] = a[i] - b[i];
  return result;
}

// The interior point method until the active set method can finish.
Result<Window> solve_window(const RateLimitedQp& problem, std::int64_t first, std::int64_t end,
                            Progress& progress) {
  RateLimitedQp part = problem;
  part.linear = problem.linear.subspan(static_cast<std::size_t>(first * problem.num_channels),
                                       static_cast<std::size_t>((end - first) * problem.num_channels));
  const ScaledQp scaled(part);
  FrameChain chain(scaled.quadratic, scaled.num_channels, scaled.num_frames);
  InteriorPoint point(scaled, chain);
  Window window{first, end, {}, {}, 0, 0, INFINITY};
  double gap = INFINITY, next_try = kSidesKnown;
  for (int stuck = 0; window.num_iterations < kMaxIterations && gap > kComplementary && stuck < kMaxStuck;) {
    if (progress.cancelled()) return Error{Errc::cancelled, "fit", "interrupted", ""};
    if (!point.iterate() || !std::isfinite(point.stationarity())) break;
    ++window.num_iterations;
    const double now = point.complementarity();
    stuck = now < 0.5 * gap ? 0 : stuck + 1;
    if (now <= next_try) {
      PolishedPoint polished;
      const bool settled = polish(scaled, chain, point.x(), point.multipliers(), polished);
      window.num_iterations += polished.num_rounds;
      if (settled)
        return Window{first,
                      end,
                      std::move(polished.x),
                      std::move(polished.pair_pull),
                      window.num_iterations,
                      polished.stationarity,
                      0};
      next_try = kNextTry * now;
    }
    if (now >= gap || (point.stationarity() > kStationary && !window.curves.empty())) continue;
    gap = now;
    if (point.stationarity() > kStationary) continue;
    window.curves = point.x();
    window.pair_pull = difference(point.multipliers().rising, point.multipliers().falling);
    window.stationarity = point.stationarity();
    window.complementarity = gap;
  }
  if (window.curves.empty()) return not_definite();
  return window;
}

// The frame of the overlap before which two windows agree best on what the ties carry, and how well: joined
// there, they fulfil the conditions of the optimum of all frames but for that difference.
std::pair<std::int64_t, double> best_joint(const Window& before, const Window& after, std::int64_t k) {
  std::pair<std::int64_t, double> best = {after.first + 1, INFINITY};
  if (before.pair_pull.empty()) return {after.first, 0.0};
  for (std::int64_t n = after.first + 1; n < before.end; ++n) {
    double worst = 0;
    for (std::int64_t i = 0; i < k; ++i)
      worst = std::max(worst, std::abs(before.pair_pull[(n - 1 - before.first) * k + i] -
                                       after.pair_pull[(n - 1 - after.first) * k + i]));
    if (worst < best.second) best = {n, worst};
  }
  return best;
}

}  // namespace

Result<QpSolution> solve(const RateLimitedQp& problem, Progress& progress) {
  const std::int64_t k = problem.num_channels;
  contract(k >= 0 && static_cast<std::int64_t>(problem.quadratic.size()) == k * k,
           "RateLimitedQp: quadratic must be [K, K]");
  contract(k == 0 ? problem.linear.empty() : problem.linear.size() % static_cast<std::size_t>(k) == 0,
           "RateLimitedQp: linear must be [T, K]");
  contract(problem.lower < problem.upper && problem.max_change > 0, "RateLimitedQp: empty limits");
  if (problem.linear.empty()) return QpSolution{};
  const auto is_finite = [](double v) { return std::isfinite(v); };
  if (!std::all_of(problem.quadratic.begin(), problem.quadratic.end(), is_finite) ||
      !std::all_of(problem.linear.begin(), problem.linear.end(), is_finite))
    return Error{Errc::input, "fit", "a value is not finite", "Check the sequence and the shapes for NaN"};
  for (std::int64_t i = 0; i < k; ++i)
    if (!(problem.quadratic[static_cast<std::size_t>(i * k + i)] > 0)) return not_definite();

  const std::int64_t num_frames = static_cast<std::int64_t>(problem.linear.size()) / k;
  progress.stage("fitting", num_frames);
  std::vector<Window> windows;
  std::vector<std::int64_t> joints = {0};  // the first frame that each window decides
  QpSolution solution;
  for (std::int64_t end = 0; end < num_frames;) {
    const std::int64_t first = end == 0 ? 0 : end - kOverlap;
    end = std::min(num_frames, first + kWindow);
    MIEN_TRY(Window next, solve_window(problem, first, end, progress));
    while (!windows.empty()) {
      const auto [joint, difference] = best_joint(windows.back(), next, k);
      if (difference <= kJoint) {
        joints.push_back(joint);
        solution.stationarity = std::max(solution.stationarity, difference);
        break;
      }
      // Limits reach across the whole overlap: both together, which may move the joint before them too.
      const std::int64_t start = windows.back().first;
      windows.pop_back();
      if (!windows.empty()) joints.pop_back();
      MIEN_TRY(next, solve_window(problem, start, end, progress));
    }
    windows.push_back(std::move(next));
    progress.update(end);
  }
  joints.push_back(num_frames);
  solution.curves.reserve(problem.linear.size());
  for (std::size_t w = 0; w < windows.size(); ++w) {
    const Window& window = windows[w];
    solution.curves.insert(solution.curves.end(), window.curves.begin() + (joints[w] - window.first) * k,
                           window.curves.begin() + (joints[w + 1] - window.first) * k);
    solution.num_iterations = std::max(solution.num_iterations, window.num_iterations);
    solution.stationarity = std::max(solution.stationarity, window.stationarity);
    solution.complementarity = std::max(solution.complementarity, window.complementarity);
  }
  return solution;
}

}  // namespace mien
