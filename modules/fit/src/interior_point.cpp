#include "interior_point.h"

#include <algorithm>
#include <cmath>

#include "wide_vectors.h"

namespace mien {
namespace {

constexpr double kKeepFromEdge = 0.995;  // of the way to the first slack or multiplier that becomes 0

// Loops over one kind of limits: slack s > 0, multiplier z > 0, and the way d that the slack goes.

MIEN_WIDE_VECTORS void add_weights(std::size_t count, const double* __restrict s, const double* __restrict z,
                                   double* __restrict out) {
  for (std::size_t i = 0; i < count; ++i) out[i] += z[i] / s[i];
}

// What a limit pulls its value away from itself: (target - ds dz) / s - z, where ds and dz are those of the
// predictor, or not there.
MIEN_WIDE_VECTORS void add_pulls(std::size_t count, const double* __restrict s, const double* __restrict z,
                                 const double* __restrict d, const double* __restrict dz, double sign,
                                 double target, double second_order, double* __restrict out) {
  for (std::size_t i = 0; i < count; ++i)
    out[i] += sign * ((target - second_order * (sign * d[i] * dz[i])) / s[i] - z[i]);
}

// The same for K changes between two frames, which pull at both.
MIEN_WIDE_VECTORS void add_pair_pulls(std::size_t count, const double* __restrict s,
                                      const double* __restrict z, const double* __restrict d,
                                      const double* __restrict dz, double sign, double target,
                                      double second_order, double* __restrict frame,
                                      double* __restrict after) {
  for (std::size_t i = 0; i < count; ++i) {
    const double pull = sign * ((target - second_order * (sign * d[i] * dz[i])) / s[i] - z[i]);
    frame[i] -= pull;
    after[i] += pull;
  }
}

// dz = pull - z / s * ds, in the place of the predictor's.
MIEN_WIDE_VECTORS void multiplier_steps(std::size_t count, const double* __restrict s,
                                        const double* __restrict z, const double* __restrict old,
                                        const double* __restrict d, double sign, double target,
                                        double second_order, double* __restrict dz) {
  for (std::size_t i = 0; i < count; ++i) {
    const double correction = second_order * (sign * old[i] * dz[i]);
    dz[i] = (target - correction - sign * d[i] * z[i]) / s[i] - z[i];
  }
}

// Largest -ds / s and -dz / z: the reciprocal of the step at which a limit is met.
MIEN_WIDE_VECTORS double steepest(std::size_t count, const double* __restrict s, const double* __restrict z,
                                  const double* __restrict d, const double* __restrict dz, double sign) {
  double lanes[16] = {};
  std::size_t i = 0;
  for (; i + 16 <= count; i += 16)
    for (std::size_t l = 0; l < 16; ++l) {
      const double a = -(sign * d[i + l]) / s[i + l], b = -dz[i + l] / z[i + l];
      const double worst = a > b ? a : b;
      lanes[l] = worst > lanes[l] ? worst : lanes[l];
    }
  double most = 0;
  for (; i < count; ++i) most = std::max({most, -(sign * d[i]) / s[i], -dz[i] / z[i]});
  for (const double lane : lanes) most = std::max(most, lane);
  return most;
}

MIEN_WIDE_VECTORS double gap_of(std::size_t count, const double* __restrict s, const double* __restrict z,
                                const double* __restrict d, const double* __restrict dz, double sign,
                                double step) {
  double lanes[16] = {};
  std::size_t i = 0;
  for (; i + 16 <= count; i += 16)
    for (std::size_t l = 0; l < 16; ++l)
      lanes[l] += (s[i + l] + step * (sign * d[i + l])) * (z[i + l] + step * dz[i + l]);
  double sum = 0;
  for (; i < count; ++i) sum += (s[i] + step * (sign * d[i])) * (z[i] + step * dz[i]);
  for (const double lane : lanes) sum += lane;
  return sum;
}

MIEN_WIDE_VECTORS void add_scaled(std::size_t count, double factor, const double* __restrict d,
                                  double* __restrict out) {
  for (std::size_t i = 0; i < count; ++i) out[i] += factor * d[i];
}

}  // namespace

InteriorPoint::InteriorPoint(const ScaledQp& problem, FrameChain& chain) : problem_(problem), chain_(chain) {
  const std::size_t size = problem.num_values(), pairs = problem.num_pairs();
  const double half = (problem.upper - problem.lower) / 2;
  // The middle of the box keeps every limit, so all later points do.
  x_.assign(size, problem.lower + half);
  for (int kind = 0; kind < 4; ++kind) {
    Kind& limits = kinds_[kind];
    limits.is_pair = kind >= 2;
    limits.sign = kind == 0 || kind == 3 ? 1 : -1;
    limits.slack.assign(limits.is_pair ? pairs : size, limits.is_pair ? problem.max_change : half);
    limits.multiplier_step.assign(limits.slack.size(), 0.0);
    multiplier(kind).assign(limits.slack.size(), 0.0);
  }
  gradient_.resize(size);
  diagonal_.resize(size);
  dx_.resize(size);
  coupling_.assign(problem.num_frames > 1 ? size - static_cast<std::size_t>(problem.num_channels) : 0, 0.0);
  change_.resize(coupling_.size());
  // Complementarity everywhere alike, of the size of the gradient that the multipliers must balance.
  lagrangian_gradient(problem_, x_, multipliers_, gradient_);
  double sum = 0;
  for (const double g : gradient_) sum += std::abs(g);
  const double mu = std::max(1e-3, sum / static_cast<double>(std::max<std::size_t>(1, size))) * half;
  for (int kind = 0; kind < 4; ++kind)
    for (std::size_t i = 0; i < kinds_[kind].slack.size(); ++i)
      multiplier(kind)[i] = mu / kinds_[kind].slack[i];
  lagrangian_gradient(problem_, x_, multipliers_, gradient_);
}

std::vector<double>& InteriorPoint::multiplier(int kind) {
  std::vector<double>* const all[] = {&multipliers_.below, &multipliers_.above, &multipliers_.rising,
                                      &multipliers_.falling};
  return *all[kind];
}
const std::vector<double>& InteriorPoint::multiplier(int kind) const {
  const std::vector<double>* const all[] = {&multipliers_.below, &multipliers_.above, &multipliers_.rising,
                                            &multipliers_.falling};
  return *all[kind];
}

bool InteriorPoint::iterate() {
  weigh();
  if (!chain_.factor(diagonal_, coupling_)) return false;
  direction(0, false);
  const double affine = std::min(1.0, longest_step());
  const double mu = gap(0), ratio = mu > 0 ? gap(affine) / mu : 0;
  direction(ratio * ratio * ratio * mu, true);
  advance(std::min(1.0, kKeepFromEdge * longest_step()));
  lagrangian_gradient(problem_, x_, multipliers_, gradient_);
  return true;
}

// G^T diag(z / s) G: what the limits add to the system.
void InteriorPoint::weigh() {
  std::fill(diagonal_.begin(), diagonal_.end(), 0.0);
  std::fill(coupling_.begin(), coupling_.end(), 0.0);
  for (int kind = 0; kind < 4; ++kind) {
    const Kind& limits = kinds_[kind];
    add_weights(limits.slack.size(), limits.slack.data(), multiplier(kind).data(),
                limits.is_pair ? coupling_.data() : diagonal_.data());
  }
}

// Newton direction towards slack * multiplier = target; `second_order` uses the steps that are there. The
// chain is factored, so that its diagonal and coupling leave room for the new steps.
void InteriorPoint::direction(double target, bool second_order) {
  const double use_old = second_order ? 1 : 0;
  const auto k = static_cast<std::size_t>(problem_.num_channels);
  for (std::size_t i = 0; i < x_.size(); ++i) diagonal_[i] = -gradient_[i];
  for (int kind = 0; kind < 4; ++kind) {
    const Kind& limits = kinds_[kind];
    const double *slack = limits.slack.data(), *steps = limits.multiplier_step.data(),
                 *multipliers = multiplier(kind).data(), *move = moves(kind).data();
    if (!limits.is_pair) {
      add_pulls(limits.slack.size(), slack, multipliers, move, steps, limits.sign, target, use_old,
                diagonal_.data());
      continue;
    }
    for (std::size_t i = 0; i < limits.slack.size(); i += k)
      add_pair_pulls(k, slack + i, multipliers + i, move + i, steps + i, limits.sign, target, use_old,
                     diagonal_.data() + i, diagonal_.data() + i + k);
  }
  chain_.solve(diagonal_, coupling_);
  for (int kind = 0; kind < 4; ++kind) {
    Kind& limits = kinds_[kind];
    multiplier_steps(limits.slack.size(), limits.slack.data(), multiplier(kind).data(), moves(kind).data(),
                     limits.is_pair ? coupling_.data() : diagonal_.data(), limits.sign, target, use_old,
                     limits.multiplier_step.data());
  }
  dx_.swap(diagonal_);
  change_.swap(coupling_);
}

double InteriorPoint::longest_step() const {
  double most = kKeepFromEdge;
  for (int kind = 0; kind < 4; ++kind) {
    const Kind& limits = kinds_[kind];
    most = std::max(most, steepest(limits.slack.size(), limits.slack.data(), multiplier(kind).data(),
                                   moves(kind).data(), limits.multiplier_step.data(), limits.sign));
  }
  return 1 / most;
}

double InteriorPoint::gap(double step) const {
  double sum = 0;
  std::size_t count = 0;
  for (int kind = 0; kind < 4; ++kind) {
    const Kind& limits = kinds_[kind];
    sum += gap_of(limits.slack.size(), limits.slack.data(), multiplier(kind).data(), moves(kind).data(),
                  limits.multiplier_step.data(), limits.sign, step);
    count += limits.slack.size();
  }
  return count == 0 ? 0 : sum / static_cast<double>(count);
}

void InteriorPoint::advance(double step) {
  add_scaled(x_.size(), step, dx_.data(), x_.data());
  for (int kind = 0; kind < 4; ++kind) {
    Kind& limits = kinds_[kind];
    add_scaled(limits.slack.size(), step * limits.sign, moves(kind).data(), limits.slack.data());
    add_scaled(limits.slack.size(), step, limits.multiplier_step.data(), multiplier(kind).data());
  }
}

}  // namespace mien
