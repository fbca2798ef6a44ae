#include "mien/fit/rate_limited_qp.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "frame_chain.h"
#include "mien/base/contract.h"
#include "wide_vectors.h"

namespace mien {
namespace {

constexpr int kMaxIterations = 80;
// Relative to the mean diagonal of P. Where a limit barely holds, slack and multiplier are both small and a
// curve is off by the root of their product, so complementarity must go far below the wanted error; the
// gradient then keeps a rounding error of about 1e-11 from multipliers that are known only that well.
constexpr double kComplementary = 1e-18, kStationary = 1e-8;
constexpr double kKeepFromEdge = 0.995;  // of the way to the first slack or multiplier that becomes 0

// The constraints of one kind, each with a slack s > 0 and a multiplier z > 0.
struct Limits {
  std::vector<double> slack, multiplier, slack_step, multiplier_step;

  void start(std::size_t count) {
    slack.assign(count, 0);
    multiplier.assign(count, 0);
    slack_step.assign(count, 0);
    multiplier_step.assign(count, 0);
  }
  // dz = (target - ds_affine dz_affine) / s - z + z / s (- ds)
  [[nodiscard]] double pull(std::size_t i, double target, bool second_order) const {
    const double correction = second_order ? slack_step[i] * multiplier_step[i] : 0.0;
    return (target - correction) / slack[i] - multiplier[i];
  }
  [[nodiscard]] double longest_step() const {
    double step = 1 / kKeepFromEdge;
    for (std::size_t i = 0; i < slack.size(); ++i) {
      if (slack_step[i] < 0) step = std::min(step, -slack[i] / slack_step[i]);
      if (multiplier_step[i] < 0) step = std::min(step, -multiplier[i] / multiplier_step[i]);
    }
    return step;
  }
  [[nodiscard]] double gap(double step) const {
    double sum = 0;
    for (std::size_t i = 0; i < slack.size(); ++i)
      sum += (slack[i] + step * slack_step[i]) * (multiplier[i] + step * multiplier_step[i]);
    return sum;
  }
  void advance(double step) {
    for (std::size_t i = 0; i < slack.size(); ++i) {
      slack[i] += step * slack_step[i];
      multiplier[i] += step * multiplier_step[i];
    }
  }
};

// y += P x for a symmetric P [K, K].
MIEN_WIDE_VECTORS void add_product(const double* p, std::int64_t k, const double* x, double* y) {
  for (std::int64_t i = 0; i < k; ++i)
    for (std::int64_t j = 0; j < k; ++j) y[j] += p[i * k + j] * x[i];
}

class InteriorPoint {
 public:
  InteriorPoint(const RateLimitedQp& problem, std::int64_t num_frames)
      : k_(problem.num_channels), t_(num_frames), chain_(scaled_quadratic(problem), k_, num_frames) {
    const auto size = static_cast<std::size_t>(t_ * k_);
    q_.assign(problem.linear.begin(), problem.linear.end());
    for (double& q : q_) q /= scale_;
    // The middle of the box keeps every limit, so all later points do.
    x_.assign(size, (problem.lower + problem.upper) / 2);
    below_.start(size);
    above_.start(size);
    std::fill(below_.slack.begin(), below_.slack.end(), (problem.upper - problem.lower) / 2);
    above_.slack = below_.slack;
    const bool has_rate = std::isfinite(problem.max_change) && t_ > 1;
    const std::size_t pairs = has_rate ? static_cast<std::size_t>((t_ - 1) * k_) : 0;
    rising_.start(pairs);
    falling_.start(pairs);
    std::fill(rising_.slack.begin(), rising_.slack.end(), problem.max_change);
    falling_.slack = rising_.slack;
    dx_.resize(size);
    gradient_.resize(size);
    diagonal_.resize(size);
    coupling_.assign(static_cast<std::size_t>(std::max<std::int64_t>(0, t_ - 1) * k_), 0.0);
    change_.resize(coupling_.size());
    begin_multipliers();
  }

  // One predictor and corrector step. False when the system cannot be factored.
  bool iterate() {
    weigh();
    if (!chain_.factor(diagonal_, coupling_)) return false;
    direction(0, false);
    const double affine = std::min(1.0, longest_step());
    const double mu = mean_gap(0), affine_mu = mean_gap(affine);
    const double ratio = affine_mu / mu;
    direction(ratio * ratio * ratio * mu, true);
    const double step = std::min(1.0, kKeepFromEdge * longest_step());
    for (std::size_t i = 0; i < x_.size(); ++i) x_[i] += step * dx_[i];
    for (Limits* limits : all()) limits->advance(step);
    measure_gradient();
    return true;
  }

  [[nodiscard]] double stationarity() const {
    double worst = 0;
    for (const double g : gradient_) worst = std::isfinite(g) ? std::max(worst, std::abs(g)) : INFINITY;
    return worst;
  }
  [[nodiscard]] double complementarity() const { return mean_gap(0); }
  [[nodiscard]] std::vector<double>& x() { return x_; }

 private:
  std::array<Limits*, 4> all() { return {&below_, &above_, &rising_, &falling_}; }
  [[nodiscard]] std::array<const Limits*, 4> all() const { return {&below_, &above_, &rising_, &falling_}; }

  std::vector<double> scaled_quadratic(const RateLimitedQp& problem) {
    double trace = 0;
    for (std::int64_t i = 0; i < k_; ++i) trace += problem.quadratic[static_cast<std::size_t>(i * k_ + i)];
    scale_ = trace / static_cast<double>(k_);
    p_.assign(problem.quadratic.begin(), problem.quadratic.end());
    for (double& p : p_) p /= scale_;
    return p_;
  }

  // Complementarity everywhere alike, of the size of the gradient that the multipliers must balance.
  void begin_multipliers() {
    measure_gradient();
    double size = 0;
    for (const double g : gradient_) size += std::abs(g);
    const double mu =
        std::max(1e-3, size / static_cast<double>(std::max<std::size_t>(1, x_.size()))) * below_.slack[0];
    for (Limits* limits : all())
      for (std::size_t i = 0; i < limits->slack.size(); ++i) limits->multiplier[i] = mu / limits->slack[i];
    measure_gradient();
  }

  // Adds what multipliers of changes do to the frames on both sides of them.
  template <class Value>
  void add_pairs(std::vector<double>& out, Value value) const {
    for (std::size_t i = 0; i < rising_.slack.size(); ++i) {
      const double v = value(i);
      out[i] -= v;
      out[i + static_cast<std::size_t>(k_)] += v;
    }
  }

  // gradient = P x + q - z_below + z_above + the pairs'
  void measure_gradient() {
    const auto k = static_cast<std::size_t>(k_);
    for (std::int64_t n = 0; n < t_; ++n) {
      const double* x = x_.data() + n * k_;
      double* g = gradient_.data() + n * k_;
      std::copy_n(q_.data() + n * k_, k, g);
      add_product(p_.data(), k_, x, g);
    }
    for (std::size_t i = 0; i < x_.size(); ++i) gradient_[i] += above_.multiplier[i] - below_.multiplier[i];
    add_pairs(gradient_, [&](std::size_t i) { return rising_.multiplier[i] - falling_.multiplier[i]; });
  }

  // G^T diag(z / s) G: what the limits add to the system.
  void weigh() {
    for (std::size_t i = 0; i < x_.size(); ++i)
      diagonal_[i] = below_.multiplier[i] / below_.slack[i] + above_.multiplier[i] / above_.slack[i];
    for (std::size_t i = 0; i < rising_.slack.size(); ++i) {
      coupling_[i] = rising_.multiplier[i] / rising_.slack[i] + falling_.multiplier[i] / falling_.slack[i];
    }
  }

  // Newton direction towards slack * multiplier = target; `second_order` uses the steps that are there.
  void direction(double target, bool second_order) {
    for (std::size_t i = 0; i < x_.size(); ++i)
      dx_[i] = -gradient_[i] + below_.pull(i, target, second_order) - above_.pull(i, target, second_order);
    add_pairs(dx_, [&](std::size_t i) {
      return falling_.pull(i, target, second_order) - rising_.pull(i, target, second_order);
    });
    chain_.solve(dx_, change_);
    const auto set = [&](Limits& limits, std::size_t i, double slack_step) {
      limits.multiplier_step[i] =
          limits.pull(i, target, second_order) - limits.multiplier[i] / limits.slack[i] * slack_step;
      limits.slack_step[i] = slack_step;
    };
    for (std::size_t i = 0; i < x_.size(); ++i) {
      set(below_, i, dx_[i]);
      set(above_, i, -dx_[i]);
    }
    for (std::size_t i = 0; i < rising_.slack.size(); ++i) {
      set(rising_, i, -change_[i]);
      set(falling_, i, change_[i]);
    }
  }

  [[nodiscard]] double longest_step() const {
    double step = 1 / kKeepFromEdge;
    for (const Limits* limits : all()) step = std::min(step, limits->longest_step());
    return step;
  }
  [[nodiscard]] double mean_gap(double step) const {
    double sum = 0;
    std::size_t count = 0;
    for (const Limits* limits : all()) {
      sum += limits->gap(step);
      count += limits->slack.size();
    }
    return count == 0 ? 0 : sum / static_cast<double>(count);
  }

  std::int64_t k_, t_;
  double scale_ = 1;
  std::vector<double> p_, q_, x_, dx_, change_, gradient_, diagonal_, coupling_;
  FrameChain chain_;
  Limits below_, above_, rising_, falling_;
};

Error not_definite() {
  return Error{Errc::input, "fit",
               "the shapes do not decide the coefficients: two of them move the face alike",
               "Leave out one of the shapes that are combinations of others, or shapes that move nothing"};
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

  InteriorPoint point(problem, static_cast<std::int64_t>(problem.linear.size()) / k);
  QpSolution solution;
  progress.stage("fitting", kMaxIterations);
  double gap = INFINITY;
  for (int stuck = 0; solution.num_iterations < kMaxIterations && gap > kComplementary && stuck < 4;) {
    if (progress.cancelled()) return Error{Errc::cancelled, "fit", "interrupted", ""};
    if (!point.iterate() || !std::isfinite(point.stationarity())) break;
    progress.update(++solution.num_iterations);
    stuck = point.complementarity() < 0.5 * gap ? 0 : stuck + 1;
    if (point.complementarity() >= gap || (point.stationarity() > kStationary && !solution.curves.empty()))
      continue;
    gap = point.complementarity();
    if (point.stationarity() > kStationary) continue;
    solution.curves = point.x();
    solution.stationarity = point.stationarity();
    solution.complementarity = gap;
  }
  if (solution.curves.empty()) return not_definite();
  return solution;
}

}  // namespace mien
