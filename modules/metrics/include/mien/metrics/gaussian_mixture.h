#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "mien/metrics/frechet_distance.h"

namespace mien {

struct GaussianMixture {
  std::vector<double> weights;  ///< sum 1
  std::vector<Gaussian> components;
};

/// The defaults of scikit-learn's GaussianMixture, which the authors of SAiD use with five components.
struct MixtureOptions {
  int num_components = 5;
  int max_iterations = 100;
  double tolerance = 1e-3;       ///< of the change of the mean log-likelihood
  double regularisation = 1e-6;  ///< added to the diagonal of every covariance
  std::uint64_t seed = 0;
};

/// A mixture with full covariances, fitted by expectation and maximisation from k-means (k-means++ start, as
/// scikit-learn: several candidates for each centre, at most 300 passes). Nothing when there are fewer rows
/// than components, values that are not finite, or a covariance that is not positive definite.
std::optional<GaussianMixture> fit_mixture(const FeatureTable& features, const MixtureOptions& options = {});

}  // namespace mien
