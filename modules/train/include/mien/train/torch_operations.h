#pragma once
#include <torch/torch.h>

#include <cstdint>
#include <vector>

#include "mien/nn/operations.h"

namespace mien {

/// LibTorch: autograd, CPU or CUDA. Tensors are [batch, rows, channels].
template <>
struct Operations<torch::Tensor> {
  using T = torch::Tensor;
  using Matrix = torch::Tensor;

  static T linear(const T& x, const Matrix& w, const T& b) {
    return b.defined() ? torch::linear(x, w, b) : torch::linear(x, w);
  }
  static T layer_norm(const T& x, const T& gamma, const T& beta) {
    return torch::layer_norm(x, {x.size(-1)}, gamma, beta, 1e-5);
  }
  static T gelu(const T& x) { return torch::gelu(x); }
  static T silu(const T& x) { return torch::silu(x); }
  static T sigmoid(const T& x) { return torch::sigmoid(x); }
  static T tanh(const T& x) { return torch::tanh(x); }
  static T add(const T& x, const T& y) { return x + y; }
  static T mul(const T& x, const T& y) { return x * y; }
  static T add_one(const T& x) { return x + 1; }
  static T scale(const T& x, float s) { return x * s; }
  static std::int64_t num_rows(const T& x) { return x.size(-2); }
  static T rows(const T& x, std::int64_t first, std::int64_t count) { return x.narrow(-2, first, count); }
  static T columns(const T& x, std::int64_t first, std::int64_t count) { return x.narrow(-1, first, count); }
  static T concat_rows(const std::vector<T>& parts) { return torch::cat(parts, -2); }
  static T concat_columns(const std::vector<T>& parts) { return torch::cat(parts, -1); }
  static T zero_rows(const T& x, std::int64_t count, std::int64_t width) {
    auto shape = x.sizes().vec();
    shape[shape.size() - 2] = count;
    shape[shape.size() - 1] = width;
    return torch::zeros(shape, x.options().requires_grad(false));
  }
  static T unfold(const T& x, std::int64_t kernel, std::int64_t dilation) {
    const std::int64_t count = x.size(-2) - (kernel - 1) * dilation;
    std::vector<T> taps;
    for (std::int64_t k = 0; k < kernel; ++k) taps.push_back(x.narrow(-2, k * dilation, count));
    return torch::cat(taps, -1);
  }
};

}  // namespace mien
