#include "mien/metrics/condition_fidelity.h"

#include <cmath>
#include <limits>
#include <map>

#include "mien/base/contract.h"
#include "mien/core/arkit.h"
#include "mien/metrics/regions.h"

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
  std::map<int, Average> contexts;
  std::map<std::pair<int, int>, Average> labels;
  for (const ConditionExample& example : examples) {
    contract(example.features.size() == examples.front().features.size(),
             "CentroidClassifier: features differ in length");
    contexts[example.context].add(example.features);
    labels[{example.context, example.label}].add(example.features);
  }
  if (examples.empty()) return;
  // Deviations around the context's mean: what the context explains must not blunt the scale.
  std::map<int, std::vector<double>> means;
  for (const auto& [context, average] : contexts) means[context] = average.value();
  std::vector<double> variance(examples.front().features.size(), 0.0);
  for (const ConditionExample& example : examples) {
    const auto& mean = means[example.context];
    for (std::size_t i = 0; i < variance.size(); ++i) {
      const double d = example.features[i] - mean[i];
      variance[i] += d * d / static_cast<double>(examples.size());
    }
  }
  for (const double v : variance) scale_.push_back(1 / std::max(kMinDeviation, std::sqrt(v)));
  for (const auto& [key, average] : labels) centroids_.push_back({key.first, key.second, average.value()});
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
  std::size_t count = 0;
  for (const Centroid& centroid : centroids_) count += centroid.context == context;
  return count;
}

FidelityCounts& FidelityCounts::operator+=(const FidelityCounts& other) {
  right += other.right;
  total += other.total;
  return *this;
}

double FidelityCounts::accuracy() const {
  return total > 0 ? static_cast<double>(right) / static_cast<double>(total)
                   : std::numeric_limits<double>::quiet_NaN();
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
