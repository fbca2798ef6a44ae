#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "mien/fit/rate_limited_qp.h"

// The problem as both solvers see it: scaled, with the limits of one kind in one array each.
namespace mien {

/// RateLimitedQp divided by the mean diagonal of P, so that metres and centimetres are the same problem.
struct ScaledQp {
  std::int64_t num_channels = 0, num_frames = 0;
  std::vector<double> quadratic, linear;  // P [K, K], q [T, K]
  double lower = 0, upper = 1, max_change = 0.1;

  explicit ScaledQp(const RateLimitedQp& problem);
  [[nodiscard]] std::size_t num_values() const { return linear.size(); }
  /// Number of changes that are limited: (T - 1) K, or none.
  [[nodiscard]] std::size_t num_pairs() const;
};

/// Multipliers of the four kinds of limits, all >= 0: below and above [T, K], rising and falling [T - 1, K]
/// (empty without limits on the change).
struct Multipliers {
  std::vector<double> below, above, rising, falling;
};

/// gradient = P x + q - below + above + what the limits on changes pull at the frames on both sides of them.
void lagrangian_gradient(const ScaledQp& problem, std::span<const double> x, const Multipliers& multipliers,
                         std::span<double> gradient);

/// Largest absolute value; infinity when one is not finite.
double largest(std::span<const double> values);

}  // namespace mien
