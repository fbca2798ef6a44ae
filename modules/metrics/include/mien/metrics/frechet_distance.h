#pragma once
#include <cstdint>
#include <span>
#include <vector>

// Distances between sets of features, as the programs of SAiD's authors compute them (specification of SAiD,
// section 8.3). All in double.
namespace mien {

/// Rows of features, [n, d].
struct FeatureTable {
  std::int64_t width = 0;
  std::vector<double> values;

  [[nodiscard]] std::int64_t num_rows() const {
    return width == 0 ? 0 : static_cast<std::int64_t>(values.size()) / width;
  }
  [[nodiscard]] std::span<const double> row(std::int64_t i) const {
    return std::span(values).subspan(static_cast<std::size_t>(i * width), static_cast<std::size_t>(width));
  }
};

/// Mean [d] and covariance [d, d].
struct Gaussian {
  std::vector<double> mean, covariance;
};

/// Mean and covariance with divisor n - 1. @pre at least two rows
Gaussian gaussian_of(const FeatureTable& features);

/// FD, the squared Wasserstein-2 distance of two Gaussians: |m1 - m2|^2 + tr S1 + tr S2 - 2 tr (S1 S2)^(1/2),
/// the last trace as the sum of the square roots of the eigenvalues of S1^(1/2) S2 S1^(1/2): it needs no full
/// rank and has no imaginary part. NaN where the covariances are not finite. @pre equal sizes
double frechet_distance(const Gaussian& a, const Gaussian& b);

}  // namespace mien
