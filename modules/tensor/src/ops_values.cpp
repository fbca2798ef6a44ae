#include <cmath>

#include "elementwise_dispatch.h"
#include "mien/tensor/ops.h"
#include "require.h"

namespace mien {
namespace {

using elementwise::Unary;

Tensor apply(Unary op, Tensor x) {
  elementwise::best_kernels().unary[static_cast<int>(op)](x.data(), x.data(), x.count());
  return x;
}

template <class Combine>
Tensor combine(const char* name, Tensor a, const Tensor& b, Combine&& f) {
  float* p = a.data();
  if (a.shape() == b.shape()) {
    for (std::int64_t i = 0; i < a.count(); ++i) p[i] = f(p[i], b.data()[i]);
    return a;
  }
  require(b.count() == a.width() && b.width() == a.width(), [&] {
    return std::string(name) + ": " + shape_text(b.shape()) + " is neither the shape nor a row of " +
           shape_text(a.shape());
  });
  const std::int64_t width = a.width();
  for (std::int64_t r = 0; r < a.num_rows(); ++r, p += width)
    for (std::int64_t i = 0; i < width; ++i) p[i] = f(p[i], b.data()[i]);
  return a;
}

}  // namespace

Tensor exp(Tensor x) { return apply(Unary::exp, std::move(x)); }
Tensor sigmoid(Tensor x) { return apply(Unary::sigmoid, std::move(x)); }
Tensor tanh(Tensor x) { return apply(Unary::tanh, std::move(x)); }
Tensor silu(Tensor x) { return apply(Unary::silu, std::move(x)); }
Tensor gelu(Tensor x) { return apply(Unary::gelu, std::move(x)); }
Tensor relu(Tensor x) { return apply(Unary::relu, std::move(x)); }

Tensor mish(Tensor x) { return apply(Unary::mish, std::move(x)); }

Tensor scale(Tensor x, float factor) {
  for (float& value : x.values()) value *= factor;
  return x;
}

Tensor add(Tensor a, const Tensor& b) {
  return combine("add", std::move(a), b, [](float x, float y) { return x + y; });
}
Tensor sub(Tensor a, const Tensor& b) {
  return combine("sub", std::move(a), b, [](float x, float y) { return x - y; });
}
Tensor mul(Tensor a, const Tensor& b) {
  return combine("mul", std::move(a), b, [](float x, float y) { return x * y; });
}

Tensor layer_norm(Tensor x, const Tensor& gamma, const Tensor& beta, double eps) {
  const std::int64_t width = x.width();
  require(gamma.count() == width && beta.count() == width, [&] {
    return "layer_norm: gamma " + shape_text(gamma.shape()) + " and beta " + shape_text(beta.shape()) +
           " must have the width of " + shape_text(x.shape());
  });
  const auto& kernels = elementwise::best_kernels();
  for (std::int64_t r = 0; r < x.num_rows(); ++r) {
    float* row = x.data() + r * width;
    kernels.layer_norm_row(row, gamma.data(), beta.data(), eps, width, row);
  }
  return x;
}

Tensor norm_over_rows(Tensor x, const Tensor& gamma, const Tensor& beta, double eps) {
  const std::int64_t width = x.width(), num_rows = x.num_rows();
  require(gamma.count() == width && beta.count() == width, [&] {
    return "norm_over_rows: gamma " + shape_text(gamma.shape()) + " and beta " + shape_text(beta.shape()) +
           " must have the width of " + shape_text(x.shape());
  });
  std::vector<double> mean(static_cast<std::size_t>(width)), variance(mean);
  const auto each = [&](auto&& use) {
    for (std::int64_t r = 0; r < num_rows; ++r)
      for (std::int64_t i = 0; i < width; ++i) use(static_cast<std::size_t>(i), x.data()[r * width + i]);
  };
  each([&](std::size_t i, float v) { mean[i] += v; });
  for (double& m : mean) m /= static_cast<double>(num_rows);
  each([&](std::size_t i, float v) { variance[i] += (v - mean[i]) * (v - mean[i]); });
  for (double& v : variance) v = 1.0 / std::sqrt(v / static_cast<double>(num_rows) + eps);
  each([&](std::size_t i, float& v) {
    v = static_cast<float>((v - mean[i]) * variance[i]) * gamma.data()[i] + beta.data()[i];
  });
  return x;
}

Tensor softmax_last(Tensor x) {
  const auto& kernels = elementwise::best_kernels();
  for (std::int64_t r = 0; r < x.num_rows(); ++r) {
    float* row = x.data() + r * x.width();
    kernels.softmax_row(row, x.width(), row);
  }
  return x;
}

}  // namespace mien
