#include "join_ease.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

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

// The values eased with one lambda. Differences count less the farther they are from the join.
std::vector<double> eased(std::span<const double> values, double lambda) {
  const std::size_t num_free = values.size() - 4;
  std::vector<std::array<double, 3>> a(num_free, {1, 0, 0});
  std::vector<double> change(num_free, 0.0);
  constexpr std::array<double, 3> kStencil = {1, -2, 1};
  for (std::size_t i = 1; i + 1 < values.size(); ++i) {
    const double nearness = 1 - static_cast<double>(i - 1) / static_cast<double>(values.size() - 2);
    const double weight = lambda * nearness * nearness, now = bend(values, i);
    for (std::size_t r = 0; r < 3; ++r) {
      const std::size_t row = i - 1 + r;
      if (row < 2 || row >= num_free + 2) continue;
      change[row - 2] -= weight * kStencil[r] * now;
      for (std::size_t c = 0; c <= r; ++c)
        if (const std::size_t column = i - 1 + c; column >= 2)
          a[row - 2][row - column] += weight * kStencil[r] * kStencil[c];
    }
  }
  solve_band(a, change);
  std::vector<double> result(values.begin(), values.end());
  for (std::size_t i = 0; i < num_free; ++i) result[i + 2] += change[i];
  return result;
}

}  // namespace

void ease_join(std::span<double> values, double at_kept, double at_free, double elsewhere) {
  if (values.size() < 6) return;
  std::vector<double> limits;
  for (std::size_t i = 1; i + 1 < values.size(); ++i)
    limits.push_back(i == 1 ? at_kept : i == 2 ? at_free : std::max(elsewhere, std::abs(bend(values, i))));
  const auto excess = [&](std::span<const double> of) {
    double most = 0;
    for (std::size_t i = 0; i < limits.size(); ++i)
      most = std::max(most, std::abs(bend(of, i + 1)) - limits[i]);
    return most;
  };
  double least = excess(values);
  if (!(least > 0)) return;
  std::vector<double> best(values.begin(), values.end());
  constexpr double kFirst = 0.05, kFactor = 2;
  constexpr int kTries = 16;
  double lambda = kFirst;
  for (int i = 0; i < kTries && least > 0; ++i, lambda *= kFactor) {
    std::vector<double> next = eased(values, lambda);
    if (const double now = excess(next); now < least) least = now, best = std::move(next);
  }
  std::ranges::copy(best, values.begin());
}

}  // namespace mien
