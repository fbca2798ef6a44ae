#include "mien/metrics/wind.h"

#include <cmath>
#include <limits>
#include <numeric>

#include "mien/base/contract.h"
#include "mien/base/hash.h"
#include "mien/base/parallel.h"
#include "mien/metrics/statistics.h"
#include "undefined.h"

namespace mien {
namespace {

/// Nodes of the transport: n sources, then m sinks. Bellman and Ford's shortest paths, because arcs that give
/// mass back have negative costs.
class Transport {
 public:
  Transport(const std::vector<double>& from, const std::vector<double>& to, const std::vector<double>& cost)
      : left_(from), room_(to), cost_(cost), plan_(cost.size(), 0.0) {}

  std::vector<double> run() {
    const double total = std::accumulate(left_.begin(), left_.end(), 0.0);
    least_ = 1e-15 * total;
    while (send()) {
    }
    return plan_;
  }

 private:
  [[nodiscard]] std::size_t num_sources() const { return left_.size(); }
  [[nodiscard]] std::size_t num_sinks() const { return room_.size(); }

  // Along the cheapest path from a source with mass to a sink with room; false when there is none.
  bool send() {
    const std::size_t n = num_sources(), m = num_sinks();
    std::vector<double> price(n + m, std::numeric_limits<double>::infinity());
    std::vector<std::size_t> before(n + m, n + m);
    for (std::size_t i = 0; i < n; ++i)
      if (left_[i] > least_) price[i] = 0;
    constexpr double kLess = 1e-12;  // a path that is not really cheaper could run in circles
    for (bool changed = true; changed;) {
      changed = false;
      const auto reach = [&](std::size_t a, std::size_t b, double step) {
        const double now = price[a] + step;
        if (!(now < price[b] - kLess * (1 + std::abs(price[b]))) && !(std::isinf(price[b]) && now < price[b]))
          return;
        price[b] = now, before[b] = a, changed = true;
      };
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < m; ++j) {
          if (!std::isinf(price[i])) reach(i, n + j, cost_[i * m + j]);
          if (!std::isinf(price[n + j]) && plan_[i * m + j] > least_) reach(n + j, i, -cost_[i * m + j]);
        }
    }
    std::size_t end = n + m;
    for (std::size_t j = 0; j < m; ++j)
      if (room_[j] > least_ && (end == n + m || price[n + j] < price[end])) end = n + j;
    if (end == n + m || std::isinf(price[end])) return false;
    double amount = room_[end - n];
    std::size_t node = end;
    for (; before[node] != n + m; node = before[node])
      if (node < n) amount = std::min(amount, plan_[node * m + before[node] - n]);
    amount = std::min(amount, left_[node]);
    left_[node] -= amount, room_[end - n] -= amount;
    for (node = end; before[node] != n + m; node = before[node]) {
      if (node >= n)
        plan_[before[node] * m + node - n] += amount;
      else
        plan_[node * m + before[node] - n] -= amount;
    }
    return true;
  }

  std::vector<double> left_, room_;
  const std::vector<double>& cost_;
  std::vector<double> plan_;
  double least_ = 0;
};

}  // namespace

std::vector<double> cheapest_transport(const std::vector<double>& from, const std::vector<double>& to,
                                       const std::vector<double>& cost) {
  contract(cost.size() == from.size() * to.size(), "cheapest_transport: a cost for every pair is needed");
  for (const double c : cost) contract(std::isfinite(c), "cheapest_transport: costs are finite");
  return Transport(from, to, cost).run();
}

MixtureDistance mixture_distance(const GaussianMixture& a, const GaussianMixture& b) {
  MixtureDistance result;
  for (const auto& from : a.components)
    for (const auto& to : b.components) result.cost.push_back(frechet_distance(from, to));
  for (const double c : result.cost)
    if (!std::isfinite(c)) {
      result.value = kNan;
      return result;
    }
  result.plan = cheapest_transport(a.weights, b.weights, result.cost);
  for (std::size_t i = 0; i < result.cost.size(); ++i) result.value += result.cost[i] * result.plan[i];
  return result;
}

WindScore wind(const FeatureTable& a, const FeatureTable& b, const WindOptions& options) {
  contract(options.num_repeats >= 1, "wind: at least one repeat is needed");
  std::vector<double> values(static_cast<std::size_t>(options.num_repeats), kNan);
  parallel_for(options.num_threads, options.num_repeats, [&](std::int64_t i) {
    MixtureOptions own = options.mixture;
    own.seed = hash_combine(options.mixture.seed, static_cast<std::uint64_t>(2 * i));
    const auto first = fit_mixture(a, own);
    own.seed = hash_combine(options.mixture.seed, static_cast<std::uint64_t>(2 * i + 1));
    const auto second = fit_mixture(b, own);
    if (first && second) values[static_cast<std::size_t>(i)] = mixture_distance(*first, *second).value;
  });
  WindScore score{mean(values), 0};
  for (const double v : values) score.deviation += (v - score.mean) * (v - score.mean);
  score.deviation = options.num_repeats < 2
                        ? kNan
                        : std::sqrt(score.deviation / static_cast<double>(options.num_repeats - 1));
  return score;
}

}  // namespace mien
