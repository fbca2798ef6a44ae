#include "mien/metrics/statistics.h"

#include <algorithm>
#include <cmath>

#include "mien/base/contract.h"
#include "undefined.h"

namespace mien {
double mean(std::span<const double> values) {
  if (values.empty()) return kNan;
  double sum = 0;
  for (const double v : values) sum += v;
  return sum / static_cast<double>(values.size());
}

double percentile(std::vector<double> values, double p) {
  contract(p >= 0 && p <= 100, "percentile: p must lie in 0 ... 100");
  if (values.empty()) return kNan;
  std::sort(values.begin(), values.end());
  const double position = static_cast<double>(values.size() - 1) * p / 100.0;
  const auto left = static_cast<std::size_t>(position);
  const std::size_t right = std::min(left + 1, values.size() - 1);
  return values[left] + (values[right] - values[left]) * (position - static_cast<double>(left));
}

double median(std::vector<double> values) { return percentile(std::move(values), 50); }

double median_absolute_deviation(const std::vector<double>& values) {
  const double middle = median(values);
  std::vector<double> deviations;
  deviations.reserve(values.size());
  for (const double v : values) deviations.push_back(std::abs(v - middle));
  return median(std::move(deviations));
}

double pearson(std::span<const double> a, std::span<const double> b) {
  contract(a.size() == b.size(), "pearson: the series differ in length");
  if (a.size() < 2) return kNan;
  const double mean_a = mean(a), mean_b = mean(b);
  double aa = 0, bb = 0, ab = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double x = a[i] - mean_a, y = b[i] - mean_b;
    aa += x * x, bb += y * y, ab += x * y;
  }
  // Rounding of the mean leaves a constant series with a variance of about 1e-32, which is not a variance.
  const double tiny = 1e-24 * static_cast<double>(a.size());
  if (aa <= tiny * std::max(1.0, mean_a * mean_a) || bb <= tiny * std::max(1.0, mean_b * mean_b)) return kNan;
  return std::clamp(ab / std::sqrt(aa * bb), -1.0, 1.0);
}

double fisher_mean(std::span<const double> r, std::span<const double> weights) {
  contract(r.size() == weights.size(), "fisher_mean: one weight per correlation");
  constexpr double kLimit = 1 - 1e-12;  // atanh(1) is infinite: a perfect clip must not drown the others
  double sum = 0, total = 0;
  for (std::size_t i = 0; i < r.size(); ++i) {
    if (std::isnan(r[i]) || weights[i] <= 0) continue;
    sum += weights[i] * std::atanh(std::clamp(r[i], -kLimit, kLimit));
    total += weights[i];
  }
  return total > 0 ? std::tanh(sum / total) : kNan;
}

double ks_distance(std::vector<double> a, std::vector<double> b) {
  if (a.empty() || b.empty()) return kNan;
  std::sort(a.begin(), a.end());
  std::sort(b.begin(), b.end());
  double largest = 0;
  for (std::size_t i = 0, j = 0; i < a.size() && j < b.size();) {
    const double x = std::min(a[i], b[j]);
    while (i < a.size() && a[i] <= x) ++i;
    while (j < b.size() && b[j] <= x) ++j;
    const double fa = static_cast<double>(i) / static_cast<double>(a.size());
    const double fb = static_cast<double>(j) / static_cast<double>(b.size());
    largest = std::max(largest, std::abs(fa - fb));
  }
  return largest;
}

std::vector<double> smooth_gaussian(std::span<const double> values, double sigma, int radius) {
  contract(sigma > 0 && radius >= 0, "smooth_gaussian: sigma and radius must be positive");
  std::vector<double> kernel;
  double sum = 0;
  for (int k = -radius; k <= radius; ++k) {
    kernel.push_back(std::exp(-0.5 * (k / sigma) * (k / sigma)));
    sum += kernel.back();
  }
  const auto n = static_cast<std::int64_t>(values.size());
  std::vector<double> out(values.size());
  for (std::int64_t i = 0; i < n; ++i) {
    double y = 0;
    for (int k = -radius; k <= radius; ++k) {
      const std::int64_t j = std::clamp<std::int64_t>(i + k, 0, n - 1);
      y += kernel[static_cast<std::size_t>(k + radius)] * values[static_cast<std::size_t>(j)];
    }
    out[static_cast<std::size_t>(i)] = y / sum;
  }
  return out;
}

}  // namespace mien
