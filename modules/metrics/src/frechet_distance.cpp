#include "mien/metrics/frechet_distance.h"

#include <Eigen/Dense>
#include <cmath>

#include "mien/base/contract.h"
#include "undefined.h"

namespace mien {
namespace {

using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using MatrixMap = Eigen::Map<const Matrix>;
using VectorMap = Eigen::Map<const Eigen::VectorXd>;

MatrixMap covariance_of(const Gaussian& g) {
  const auto d = static_cast<Eigen::Index>(g.mean.size());
  return {g.covariance.data(), d, d};
}

// S^(1/2), with eigenvalues that rounding brought below 0 as 0.
Matrix root(const Matrix& symmetric) {
  const Eigen::SelfAdjointEigenSolver<Matrix> solver(symmetric);
  const Eigen::VectorXd roots = solver.eigenvalues().cwiseMax(0).cwiseSqrt();
  return solver.eigenvectors() * roots.asDiagonal() * solver.eigenvectors().transpose();
}

}  // namespace

Gaussian gaussian_of(const FeatureTable& features) {
  const auto n = static_cast<Eigen::Index>(features.num_rows()),
             d = static_cast<Eigen::Index>(features.width);
  contract(n >= 2, "gaussian_of: at least two rows are needed");
  const MatrixMap rows(features.values.data(), n, d);
  Gaussian result;
  const Eigen::VectorXd mean = rows.colwise().mean();
  Matrix covariance = Matrix::Zero(d, d);
  constexpr Eigen::Index kBlock = 4096;
  for (Eigen::Index first = 0; first < n; first += kBlock) {
    const Matrix off = rows.middleRows(first, std::min(kBlock, n - first)).rowwise() - mean.transpose();
    covariance.noalias() += off.transpose() * off;
  }
  covariance /= static_cast<double>(n - 1);
  result.mean.assign(mean.data(), mean.data() + d);
  result.covariance.assign(covariance.data(), covariance.data() + d * d);
  return result;
}

double frechet_distance(const Gaussian& a, const Gaussian& b) {
  contract(a.mean.size() == b.mean.size() && a.covariance.size() == a.mean.size() * a.mean.size() &&
               b.covariance.size() == a.covariance.size(),
           "frechet_distance: Gaussians of different sizes");
  if (a.mean.empty()) return 0;
  const auto d = static_cast<Eigen::Index>(a.mean.size());
  const auto s1 = covariance_of(a), s2 = covariance_of(b);
  if (!s1.allFinite() || !s2.allFinite()) return kNan;
  const Matrix half = root(s1);
  const Matrix product = half * s2 * half;
  const Eigen::SelfAdjointEigenSolver<Matrix> solver((product + product.transpose()) / 2,
                                                     Eigen::EigenvaluesOnly);
  const double cross = solver.eigenvalues().cwiseMax(0).cwiseSqrt().sum();
  const double apart = (VectorMap(a.mean.data(), d) - VectorMap(b.mean.data(), d)).squaredNorm();
  return apart + s1.trace() + s2.trace() - 2 * cross;
}

}  // namespace mien
