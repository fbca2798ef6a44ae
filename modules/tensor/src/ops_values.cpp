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

Tensor gelu_tanh(Tensor x) {
  constexpr float kRoot = 0.7978845608f, kCubic = 0.044715f;  // sqrt(2 / pi)
  Tensor inner = x;
  for (float& v : inner.values()) v = kRoot * (v + kCubic * v * v * v);
  inner = tanh(std::move(inner));
  for (std::int64_t i = 0; i < x.count(); ++i) x.data()[i] *= 0.5f * (1.0f + inner.data()[i]);
  return x;
}

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

Tensor group_norm(Tensor x, const Tensor& gamma, const Tensor& beta, std::int64_t groups, double eps) {
  const std::int64_t width = x.width(), num_rows = x.num_rows();
  require(gamma.count() == width && beta.count() == width && groups >= 1 && width % groups == 0, [&] {
    return "group_norm: gamma " + shape_text(gamma.shape()) + ", beta " + shape_text(beta.shape()) + " and " +
           std::to_string(groups) + " groups do not fit " + shape_text(x.shape());
  });
  const std::int64_t size = width / groups;  // channels of a group
  const double count = static_cast<double>(num_rows) * static_cast<double>(size);
  std::vector<double> mean(static_cast<std::size_t>(groups)), factor(mean);
  const auto each = [&](auto&& use) {
    float* value = x.data();
    for (std::int64_t r = 0; r < num_rows; ++r)
      for (std::int64_t g = 0, i = 0; g < groups; ++g)
        for (std::int64_t end = i + size; i < end; ++i) use(static_cast<std::size_t>(g), i, *value++);
  };
  each([&](std::size_t g, std::int64_t, float v) { mean[g] += v; });
  for (double& m : mean) m /= count;
  each([&](std::size_t g, std::int64_t, float v) { factor[g] += (v - mean[g]) * (v - mean[g]); });
  for (double& f : factor) f = 1.0 / std::sqrt(f / count + eps);
  each([&](std::size_t g, std::int64_t i, float& v) {
    v = static_cast<float>((v - mean[g]) * factor[g]) * gamma.data()[i] + beta.data()[i];
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
