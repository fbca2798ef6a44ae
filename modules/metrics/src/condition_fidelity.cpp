#include "mien/metrics/condition_fidelity.h"

#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <tuple>

#include "mien/base/contract.h"
#include "mien/core/arkit.h"
#include "mien/metrics/regions.h"
#include "undefined.h"

namespace mien {
namespace {

constexpr double kMinDeviation = 1e-3;  // features are coefficients: less than a thousandth is no movement

struct Average {
  std::vector<double> sum;
  double count = 0;

  void add(const std::vector<double>& values) {
    sum.resize(values.size(), 0.0);
    for (std::size_t i = 0; i < values.size(); ++i) sum[i] += values[i];
    ++count;
  }
  [[nodiscard]] std::vector<double> value() const {
    std::vector<double> out = sum;
    for (double& v : out) v /= count;
    return out;
  }
};

}  // namespace

std::vector<double> condition_features(const Motion& motion) {
  require_performance(motion);
  std::vector<double> out(2 * kNumArkit, 0.0);
  const auto count = static_cast<double>(motion.num_frames());
  if (count == 0) return out;
  for (std::int64_t n = 0; n < motion.num_frames(); ++n)
    for (std::size_t c = 0; c < kNumArkit; ++c) out[c] += motion.frame(n)[c] / count;
  for (std::int64_t n = 0; n < motion.num_frames(); ++n) {
    for (std::size_t c = 0; c < kNumArkit; ++c) {
      const double d = motion.frame(n)[c] - out[c];
      out[kNumArkit + c] += d * d / count;
    }
  }
  for (std::size_t c = 0; c < kNumArkit; ++c) out[kNumArkit + c] = std::sqrt(out[kNumArkit + c]);
  return out;
}

CentroidClassifier::CentroidClassifier(std::span<const ConditionExample> examples) {
  using Key = std::tuple<int, int, int>;
  const auto key_of = [](const ConditionExample& e) { return Key{e.context, e.label, e.variety}; };
  std::map<Key, Average> averages;
  for (const ConditionExample& example : examples) {
    contract(example.features.size() == examples.front().features.size(),
             "CentroidClassifier: features differ in length");
    averages[key_of(example)].add(example.features);
  }
  if (examples.empty()) return;
  std::map<Key, std::vector<double>> centroids;
  for (const auto& [key, average] : averages) centroids[key] = average.value();
  std::vector<double> variance(examples.front().features.size(), 0.0);
  for (const ConditionExample& example : examples) {
    const auto& centroid = centroids[key_of(example)];
    for (std::size_t i = 0; i < variance.size(); ++i) {
      const double d = example.features[i] - centroid[i];
      variance[i] += d * d / static_cast<double>(examples.size());
    }
  }
  for (const double v : variance) scale_.push_back(1 / std::max(kMinDeviation, std::sqrt(v)));
  for (const auto& [key, values] : centroids)
    centroids_.push_back({std::get<0>(key), std::get<1>(key), std::get<2>(key), values});
}

int CentroidClassifier::predict(std::span<const double> features, int context) const {
  int best = -1;
  double nearest = std::numeric_limits<double>::infinity();
  for (const Centroid& centroid : centroids_) {
    if (centroid.context != context) continue;
    contract(features.size() == centroid.values.size(), "CentroidClassifier: features differ in length");
    double distance = 0;
    for (std::size_t i = 0; i < features.size(); ++i) {
      const double d = (features[i] - centroid.values[i]) * scale_[i];
      distance += d * d;
    }
    if (distance < nearest) nearest = distance, best = centroid.label;
  }
  return best;
}

std::size_t CentroidClassifier::num_labels(int context) const {
  std::set<int> labels;
  for (const Centroid& centroid : centroids_)
    if (centroid.context == context) labels.insert(centroid.label);
  return labels.size();
}

FidelityCounts& FidelityCounts::operator+=(const FidelityCounts& other) {
  right += other.right;
  total += other.total;
  return *this;
}

double FidelityCounts::accuracy() const {
  return total > 0 ? static_cast<double>(right) / static_cast<double>(total) : kNan;
}

FidelityCounts judge(const CentroidClassifier& classifier, std::span<const ConditionExample> examples) {
  FidelityCounts out;
  for (const ConditionExample& example : examples) {
    if (classifier.num_labels(example.context) < 2) continue;
    ++out.total;
    out.right += classifier.predict(example.features, example.context) == example.label;
  }
  return out;
}

}  // namespace mien
