#pragma once
#include <cstdint>
#include <vector>

#include "mien/base/random.h"
#include "mien/metrics/frechet_distance.h"

namespace mien {

/// Which of k clusters each row belongs to: Lloyd's algorithm from a k-means++ start (Arthur and
/// Vassilvitskii 2007), 2 + ln k candidates for each centre, until nothing changes, the centres move by less
/// than 1e-4 of the mean variance (squared), or 300 passes. A cluster that loses all rows takes the row
/// farthest from its centre. @pre 1 <= k <= rows
std::vector<int> k_means(const FeatureTable& features, int k, Rng& random);

}  // namespace mien
