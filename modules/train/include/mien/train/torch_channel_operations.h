#pragma once
#include "mien/nn/channel_operations.h"
#include "mien/train/torch_operations.h"

namespace mien {

/// Tensors are [batch, rows, channels].
template <>
struct ChannelOperations<torch::Tensor> {
  using T = torch::Tensor;
  static T batch_norm(const T& x, const T& gamma, const T& beta, const T& mean, const T& variance,
                      double eps) {
    return (x - mean) * (gamma / (variance + eps).sqrt()) + beta;
  }
  static T leaky_relu(const T& x, float slope) { return torch::leaky_relu(x, slope); }
  static T transposed_conv(const T& x, const T& weight, const T& bias) {
    return torch::conv_transpose1d(x.transpose(-1, -2), weight, bias).transpose(-1, -2);
  }
  static T instance_norm(const T& x, double eps) {
    return Operations<T>::group_norm(x, {}, {}, x.size(-1), eps);
  }
  static T channel_runs(const T& x, std::int64_t width) {
    return x.transpose(-1, -2).reshape({x.size(0), -1, width});
  }
  static T from_channel_runs(const T& x, std::int64_t count) {
    return x.reshape({x.size(0), -1, count}).transpose(-1, -2);
  }
  static T squared_distances(const T& x, const T& table) {
    return x.square().sum(-1, /*keepdim=*/true) + table.square().sum(-1) - 2 * torch::matmul(x, table.t());
  }
  static T straight_through(const T& x, const T& y) { return x + (y - x).detach(); }
};

}  // namespace mien
