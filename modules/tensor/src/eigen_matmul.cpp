// One thread inside Eigen: the rows are shared out here, and OpenMP threads of two owners would fight.
#define EIGEN_DONT_PARALLELIZE
#include <Eigen/Core>

#include "backends.h"
#include "mien/base/parallel.h"

namespace mien {
namespace {

using Matrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using ConstMap = Eigen::Map<const Matrix, 0, Eigen::OuterStride<>>;
using MutableMap = Eigen::Map<Matrix, 0, Eigen::OuterStride<>>;

constexpr std::int64_t kWorthAnEigenThread = 4'000'000;  // multiply-adds

class EigenKernel final : public PackedMatrix::Kernel {
 public:
  EigenKernel(const float* weights, std::int64_t num_outputs, std::int64_t num_inputs)
      : weights_(Eigen::Map<const Matrix>(weights, num_outputs, num_inputs)) {}

  void run(const View& x, const float* bias, float* y, int num_threads) const override {
    const std::int64_t n = weights_.rows(), k = weights_.cols();
    const std::int64_t parts =
        std::clamp<std::int64_t>(x.rows * n * k / kWorthAnEigenThread, 1, std::max(num_threads, 1));
    const std::int64_t share = (x.rows + parts - 1) / parts;
    parallel_for(num_threads, (x.rows + share - 1) / share, [&](std::int64_t i) {
      const std::int64_t first = i * share, rows = std::min(share, x.rows - first);
      const ConstMap in(x.data + first * x.stride, rows, k, Eigen::OuterStride<>(x.stride));
      MutableMap out(y + first * n, rows, n, Eigen::OuterStride<>(n));
      out.noalias() = in * weights_.transpose();
      if (bias != nullptr) out.rowwise() += Eigen::Map<const Eigen::RowVectorXf>(bias, n);
    });
  }

 private:
  Matrix weights_;  // [N, K]
};

}  // namespace

KernelPtr make_eigen_kernel(const float* weights, std::int64_t num_outputs, std::int64_t num_inputs) {
  return std::make_shared<EigenKernel>(weights, num_outputs, num_inputs);
}

bool eigen_available() { return true; }

}  // namespace mien
