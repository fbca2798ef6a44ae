#include "mien/metrics/gaussian_mixture.h"

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <numbers>

#include "k_means.h"
#include "mien/base/contract.h"

namespace mien {
namespace {

using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Vector = Eigen::VectorXd;
constexpr Eigen::Index kBlock = 2048;  // rows at a time: responsibilities and differences stay in the cache

struct Component {
  double weight = 0;
  Vector mean;
  Matrix covariance;
};

/// Expectation and maximisation on rows [n, d].
class MixtureFit {
 public:
  MixtureFit(const FeatureTable& features, const MixtureOptions& options)
      : rows_(features.values.data(), features.num_rows(), features.width), options_(options) {}

  std::optional<GaussianMixture> run(const FeatureTable& features) {
    Rng random(options_.seed);
    const auto labels = k_means(features, options_.num_components, random);
    Matrix shares = Matrix::Zero(rows_.rows(), options_.num_components);
    for (Eigen::Index i = 0; i < rows_.rows(); ++i) shares(i, labels[static_cast<std::size_t>(i)]) = 1;
    maximise(shares);
    double likelihood = -std::numeric_limits<double>::infinity();
    for (int i = 0; i < options_.max_iterations; ++i) {
      const double before = likelihood;
      const auto now = expect(shares);
      if (!now) return std::nullopt;
      likelihood = *now;
      maximise(shares);
      if (std::abs(likelihood - before) < options_.tolerance) break;
    }
    return result();
  }

 private:
  // Fills the share of every component in every row; the mean log-likelihood.
  std::optional<double> expect(Matrix& shares) const {
    const Eigen::Index n = rows_.rows(), d = rows_.cols();
    std::vector<Eigen::LLT<Matrix>> factors;
    Vector constants(static_cast<Eigen::Index>(components_.size()));
    for (std::size_t k = 0; k < components_.size(); ++k) {
      factors.emplace_back(components_[k].covariance);
      if (factors.back().info() != Eigen::Success) return std::nullopt;
      const Matrix lower = factors.back().matrixL();
      constants[static_cast<Eigen::Index>(k)] = std::log(components_[k].weight) -
                                                lower.diagonal().array().log().sum() -
                                                0.5 * static_cast<double>(d) * std::log(2 * std::numbers::pi);
    }
    if (!constants.allFinite()) return std::nullopt;
    double sum = 0;
    for (Eigen::Index first = 0; first < n; first += kBlock) {
      const Eigen::Index count = std::min(kBlock, n - first);
      for (std::size_t k = 0; k < components_.size(); ++k) {
        const auto column = static_cast<Eigen::Index>(k);
        Eigen::MatrixXd off =
            (rows_.middleRows(first, count).rowwise() - components_[k].mean.transpose()).transpose();
        factors[k].matrixL().solveInPlace(off);
        shares.col(column).segment(first, count) =
            (constants[column] - 0.5 * off.colwise().squaredNorm().array()).transpose();
      }
      for (Eigen::Index i = first; i < first + count; ++i) {
        const double most = shares.row(i).maxCoeff();
        const double log_sum = most + std::log((shares.row(i).array() - most).exp().sum());
        shares.row(i) = (shares.row(i).array() - log_sum).exp();
        sum += log_sum;
      }
    }
    return sum / static_cast<double>(n);
  }

  void maximise(const Matrix& shares) {
    const Eigen::Index n = rows_.rows(), d = rows_.cols();
    constexpr double kLeast = 10 * std::numeric_limits<double>::epsilon();  // scikit-learn's guard
    components_.assign(static_cast<std::size_t>(shares.cols()), {0, Vector::Zero(d), Matrix::Zero(d, d)});
    for (Eigen::Index k = 0; k < shares.cols(); ++k) {
      Component& c = components_[static_cast<std::size_t>(k)];
      const double total = shares.col(k).sum() + kLeast;
      c.weight = total / static_cast<double>(n);
      c.mean = rows_.transpose() * shares.col(k) / total;
      for (Eigen::Index first = 0; first < n; first += kBlock) {
        const Eigen::Index count = std::min(kBlock, n - first);
        const Matrix off = rows_.middleRows(first, count).rowwise() - c.mean.transpose();
        const Matrix weighted = off.array().colwise() * shares.col(k).segment(first, count).array();
        c.covariance.noalias() += weighted.transpose() * off;
      }
      c.covariance /= total;
      c.covariance.diagonal().array() += options_.regularisation;
    }
  }

  [[nodiscard]] GaussianMixture result() const {
    GaussianMixture mixture;
    double sum = 0;
    for (const Component& c : components_) sum += c.weight;
    for (const Component& c : components_) {
      mixture.weights.push_back(c.weight / sum);
      mixture.components.push_back({{c.mean.data(), c.mean.data() + c.mean.size()},
                                    {c.covariance.data(), c.covariance.data() + c.covariance.size()}});
    }
    return mixture;
  }

  Eigen::Map<const Matrix> rows_;
  MixtureOptions options_;
  std::vector<Component> components_;
};

}  // namespace

std::optional<GaussianMixture> fit_mixture(const FeatureTable& features, const MixtureOptions& options) {
  contract(options.num_components >= 1, "fit_mixture: at least one component is needed");
  if (features.num_rows() < options.num_components) return std::nullopt;
  for (const double x : features.values)
    if (!std::isfinite(x)) return std::nullopt;
  return MixtureFit(features, options).run(features);
}

}  // namespace mien
