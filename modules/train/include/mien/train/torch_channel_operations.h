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
  static T flatten_channels(const T& x) { return x.transpose(-1, -2).reshape({x.size(0), 1, -1}); }
  static T split_channels(const T& x, std::int64_t channels) {
    return x.reshape({x.size(0), channels, -1}).transpose(-1, -2);
  }
};

}  // namespace mien
