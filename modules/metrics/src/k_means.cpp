#include "k_means.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "mien/base/contract.h"

namespace mien {
namespace {

constexpr int kMaxPasses = 300;
constexpr double kTolerance = 1e-4;

double squared_distance(std::span<const double> a, std::span<const double> b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sum;
}

std::vector<double> copied(std::span<const double> row) { return {row.begin(), row.end()}; }

// The row at which the running sum of `closest` passes a random share of the whole.
std::int64_t drawn_row(const std::vector<double>& closest, double total, Rng& random) {
  double rest = random.uniform() * total;
  for (std::size_t i = 0; i + 1 < closest.size(); ++i) {
    rest -= closest[i];
    if (rest < 0) return static_cast<std::int64_t>(i);
  }
  return static_cast<std::int64_t>(closest.size()) - 1;
}

std::vector<std::vector<double>> first_centres(const FeatureTable& features, int k, Rng& random) {
  const std::int64_t n = features.num_rows();
  const int num_candidates = 2 + static_cast<int>(std::log(k));
  std::vector<std::vector<double>> centres = {
      copied(features.row(static_cast<std::int64_t>(random.below(static_cast<std::uint64_t>(n)))))};
  std::vector<double> closest(static_cast<std::size_t>(n), std::numeric_limits<double>::infinity());
  const auto closer = [&](std::span<const double> centre) {
    std::vector<double> next = closest;
    for (std::int64_t i = 0; i < n; ++i) {
      double& d = next[static_cast<std::size_t>(i)];
      d = std::min(d, squared_distance(features.row(i), centre));
    }
    return next;
  };
  closest = closer(centres.front());
  while (static_cast<int>(centres.size()) < k) {
    const double total = std::accumulate(closest.begin(), closest.end(), 0.0);
    std::vector<double> best;
    double least = std::numeric_limits<double>::infinity();
    std::int64_t chosen = 0;
    for (int c = 0; c < num_candidates; ++c) {
      const std::int64_t row = drawn_row(closest, total, random);
      std::vector<double> next = closer(features.row(row));
      const double sum = std::accumulate(next.begin(), next.end(), 0.0);
      if (!(sum < least)) continue;
      least = sum, best = std::move(next), chosen = row;
    }
    centres.push_back(copied(features.row(chosen)));
    if (!best.empty()) closest = std::move(best);
  }
  return centres;
}

double mean_variance(const FeatureTable& features) {
  double sum = 0;
  const auto n = static_cast<double>(features.num_rows());
  for (std::int64_t c = 0; c < features.width; ++c) {
    double mean = 0, squares = 0;
    for (std::int64_t i = 0; i < features.num_rows(); ++i)
      mean += features.row(i)[static_cast<std::size_t>(c)] / n;
    for (std::int64_t i = 0; i < features.num_rows(); ++i) {
      const double off = features.row(i)[static_cast<std::size_t>(c)] - mean;
      squares += off * off / n;
    }
    sum += squares;
  }
  return sum / static_cast<double>(features.width);
}

}  // namespace

std::vector<int> k_means(const FeatureTable& features, int k, Rng& random) {
  const std::int64_t n = features.num_rows();
  contract(k >= 1 && n >= k, "k_means: as many rows as clusters are needed");
  auto centres = first_centres(features, k, random);
  const double tolerance = kTolerance * mean_variance(features);
  std::vector<int> labels(static_cast<std::size_t>(n), -1);
  std::vector<double> distance(static_cast<std::size_t>(n));
  const auto assign = [&] {
    bool changed = false;
    for (std::int64_t i = 0; i < n; ++i) {
      int best = 0;
      double least = std::numeric_limits<double>::infinity();
      for (int c = 0; c < k; ++c) {
        const double d = squared_distance(features.row(i), centres[static_cast<std::size_t>(c)]);
        if (d < least) least = d, best = c;
      }
      int& label = labels[static_cast<std::size_t>(i)];
      changed = changed || label != best;
      label = best, distance[static_cast<std::size_t>(i)] = least;
    }
    return changed;
  };
  for (int pass = 0; pass < kMaxPasses; ++pass) {
    if (!assign()) return labels;
    std::vector<std::vector<double>> sums(static_cast<std::size_t>(k),
                                          std::vector<double>(static_cast<std::size_t>(features.width), 0.0));
    std::vector<std::int64_t> counts(static_cast<std::size_t>(k), 0);
    for (std::int64_t i = 0; i < n; ++i) {
      const auto c = static_cast<std::size_t>(labels[static_cast<std::size_t>(i)]);
      const auto row = features.row(i);
      for (std::size_t j = 0; j < row.size(); ++j) sums[c][j] += row[j];
      ++counts[c];
    }
    double moved = 0;
    for (std::size_t c = 0; c < centres.size(); ++c) {
      std::vector<double> next;
      if (counts[c] == 0) {
        const auto far = std::ranges::max_element(distance);
        next = copied(features.row(far - distance.begin()));
        *far = 0;
      } else {
        next = std::move(sums[c]);
        for (double& x : next) x /= static_cast<double>(counts[c]);
      }
      moved += squared_distance(next, centres[c]);
      centres[c] = std::move(next);
    }
    if (moved <= tolerance) break;
  }
  assign();
  return labels;
}

}  // namespace mien
