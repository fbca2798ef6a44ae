#pragma once
#include <cstdint>

#include "mien/metrics/frechet_distance.h"

namespace mien {

/// How much repetitions of one utterance differ (specification of SAiD, section 8.3): for every group of
/// repetitions the i-th of the first half is compared with the i-th of the second; the mean Euclidean
/// distance over all pairs of all groups. The last of an odd number is left out. (The paper pairs random
/// subsets.)
class Multimodality {
 public:
  /// @param repetitions  [R, d], in the order of their names
  void add_group(const FeatureTable& repetitions);
  /// @pre equal sizes
  void add_pairs(const FeatureTable& a, const FeatureTable& b);
  [[nodiscard]] std::int64_t num_pairs() const { return num_pairs_; }
  /// NaN without pairs.
  [[nodiscard]] double value() const;

 private:
  double sum_ = 0;
  std::int64_t num_pairs_ = 0;
};

}  // namespace mien
