#include "join_ease.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "mien/base/contract.h"

namespace mien {
namespace {

// Second difference centred on values[i].
double bend(std::span<const double> values, std::size_t i) {
  return values[i - 1] - 2 * values[i] + values[i + 1];
}

// Solves A x = b in place for a symmetric positive definite A whose entries beyond the second diagonal are 0.
// a[i] holds A(i, i), A(i, i - 1), A(i, i - 2).
void solve_band(std::vector<std::array<double, 3>>& a, std::vector<double>& b) {
  const std::size_t n = a.size();
  for (std::size_t i = 0; i < n; ++i) {  // L L^T
    for (std::size_t back = std::min<std::size_t>(2, i); back > 0; --back) {
      double sum = a[i][back];
      if (back == 1 && i >= 2) sum -= a[i][2] * a[i - 1][1];
      a[i][back] = sum / a[i - back][0];
    }
    double square = a[i][0];
    for (std::size_t back = 1; back <= std::min<std::size_t>(2, i); ++back) square -= a[i][back] * a[i][back];
    a[i][0] = std::sqrt(square);
  }
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t back = 1; back <= std::min<std::size_t>(2, i); ++back) b[i] -= a[i][back] * b[i - back];
    b[i] /= a[i][0];
  }
  for (std::size_t i = n; i-- > 0;) {
    for (std::size_t ahead = 1; ahead <= 2 && i + ahead < n; ++ahead)
      b[i] -= a[i + ahead][ahead] * b[i + ahead];
    b[i] /= a[i][0];
  }
}

// The values eased with one lambda, of which the first `num_fixed` and the last two stay. Differences count
// less the farther they are from the join.
std::vector<double> eased(std::span<const double> values, std::size_t num_fixed, double lambda) {
  std::vector<double> result(values.begin(), values.end());
  const std::size_t end = values.size() - 2;
  if (num_fixed >= end) return result;
  std::vector<std::array<double, 3>> a(end - num_fixed, {1, 0, 0});
  std::vector<double> change(a.size(), 0.0);
  constexpr std::array<double, 3> kStencil = {1, -2, 1};
  for (std::size_t i = 1; i + 1 < values.size(); ++i) {
    const double nearness = 1 - static_cast<double>(i - 1) / static_cast<double>(values.size() - 2);
    const double weight = lambda * nearness * nearness, now = bend(values, i);
    for (std::size_t r = 0; r < 3; ++r) {
      const std::size_t row = i - 1 + r;
      if (row < num_fixed || row >= end) continue;
      change[row - num_fixed] -= weight * kStencil[r] * now;
      for (std::size_t c = 0; c <= r; ++c)
        if (const std::size_t column = i - 1 + c; column >= num_fixed)
          a[row - num_fixed][row - column] += weight * kStencil[r] * kStencil[c];
    }
  }
  solve_band(a, change);
  for (std::size_t i = 0; i < change.size(); ++i) result[i + num_fixed] += change[i];
  return result;
}

// Values that may be. Without any (low above high) it is the nearest one that a later limit() has.
struct Allowed {
  double value;
  void limit(double low, double high) { value = std::max(low, std::min(value, high)); }
};

bool is_rough(std::span<const double> values, const EaseLimits& limits) {
  return std::abs(bend(values, 1)) > limits.at_kept || std::abs(bend(values, 2)) > limits.at_free;
}

// The values with the first two free ones where the join may have them at a share of its limits, and the rest
// eased behind them.
std::vector<double> eased_within(std::span<const double> values, const EaseLimits& limits, double share,
                                 double lambda) {
  const double at_kept = share * limits.at_kept, at_free = share * limits.at_free;
  std::vector<double> fixed(values.begin(), values.end());
  std::vector<double> next = eased(fixed, 2, lambda);
  const double last = fixed[1], onward = 2 * last - fixed[0];
  Allowed first{next[2]};
  first.limit((limits.low[3] + last - at_free) / 2, (limits.high[3] + last + at_free) / 2);  // for the second
  first.limit(onward - at_kept, onward + at_kept);
  first.limit(limits.low[2], limits.high[2]);
  if (first.value != next[2]) {
    fixed[2] = first.value;
    next = eased(fixed, 3, lambda);
  }
  Allowed second{next[3]};
  const double straight = 2 * next[2] - last;
  second.limit(straight - at_free, straight + at_free);
  second.limit(limits.low[3], limits.high[3]);
  if (second.value != next[3]) {
    fixed[2] = first.value;
    fixed[3] = second.value;
    next = eased(fixed, 4, lambda);
  }
  return next;
}

}  // namespace

double ease_join(std::span<double> values, const EaseLimits& limits) {
  contract(values.size() >= 6 && limits.low.size() == values.size() && limits.high.size() == values.size(),
           "ease_join: two values are kept, at least two move and two stay");
  if (!is_rough(values, limits)) return 0;
  std::vector<double> others;  // [3 ...]
  for (std::size_t i = 3; i + 1 < values.size(); ++i)
    others.push_back(std::max(limits.elsewhere, std::abs(bend(values, i))));
  double least = std::numeric_limits<double>::infinity();
  std::vector<double> best;
  constexpr double kFirst = 0.05, kFactor = 2;
  constexpr int kTries = 16;
  double lambda = kFirst;
  for (int i = 0; i < kTries && least > 0; ++i, lambda *= kFactor) {
    // Within the limits by more than single precision, unless the range leaves no room.
    std::vector<double> next = eased_within(values, limits, 0.999, lambda);
    if (is_rough(next, limits)) next = eased_within(values, limits, 1, lambda);
    double excess = 0;
    for (std::size_t k = 0; k < others.size(); ++k)
      excess = std::max(excess, std::abs(bend(next, k + 3)) - others[k]);
    if (excess < least) least = excess, best = std::move(next);
  }
  std::ranges::copy(best, values.begin());
  return least;
}

}  // namespace mien
