#include "scaled_qp.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "wide_vectors.h"

namespace mien {
namespace {

// y = q + P x for a symmetric P [K, K].
MIEN_WIDE_VECTORS void affine(const double* p, std::int64_t k, const double* q, const double* x, double* y) {
  for (std::int64_t j = 0; j < k; ++j) y[j] = q[j];
  std::int64_t i = 0;
  for (; i + 4 <= k; i += 4) {
    const double *a = p + i * k, *b = a + k, *c = b + k, *d = c + k;
    const double xa = x[i], xb = x[i + 1], xc = x[i + 2], xd = x[i + 3];
    for (std::int64_t j = 0; j < k; ++j) y[j] += (a[j] * xa + b[j] * xb) + (c[j] * xc + d[j] * xd);
  }
  for (; i < k; ++i)
    for (std::int64_t j = 0; j < k; ++j) y[j] += p[i * k + j] * x[i];
}

}  // namespace

ScaledQp::ScaledQp(const RateLimitedQp& problem)
    : num_channels(problem.num_channels),
      num_frames(static_cast<std::int64_t>(problem.linear.size()) / problem.num_channels),
      quadratic(problem.quadratic.begin(), problem.quadratic.end()),
      linear(problem.linear.begin(), problem.linear.end()),
      lower(problem.lower),
      upper(problem.upper),
      max_change(problem.max_change) {
  double trace = 0;
  for (std::int64_t i = 0; i < num_channels; ++i)
    trace += quadratic[static_cast<std::size_t>(i * num_channels + i)];
  const double scale = trace / static_cast<double>(num_channels);
  for (double& p : quadratic) p /= scale;
  for (double& q : linear) q /= scale;
}

std::size_t ScaledQp::num_pairs() const {
  return std::isfinite(max_change) && num_frames > 1
             ? static_cast<std::size_t>((num_frames - 1) * num_channels)
             : 0;
}

void lagrangian_gradient(const ScaledQp& problem, std::span<const double> x, const Multipliers& multipliers,
                         std::span<double> gradient) {
  const std::int64_t k = problem.num_channels;
  for (std::int64_t n = 0; n < problem.num_frames; ++n)
    affine(problem.quadratic.data(), k, problem.linear.data() + n * k, x.data() + n * k,
           gradient.data() + n * k);
  for (std::size_t i = 0; i < gradient.size(); ++i)
    gradient[i] += multipliers.above[i] - multipliers.below[i];
  for (std::size_t i = 0; i < multipliers.rising.size(); ++i) {
    const double pull = multipliers.rising[i] - multipliers.falling[i];
    gradient[i] -= pull;
    gradient[i + static_cast<std::size_t>(k)] += pull;
  }
}

double largest(std::span<const double> values) {
  double worst = 0;
  for (const double v : values) {
    if (!std::isfinite(v)) return std::numeric_limits<double>::infinity();
    worst = std::max(worst, std::abs(v));
  }
  return worst;
}

}  // namespace mien
