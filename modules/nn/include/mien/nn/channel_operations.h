#pragma once
#include "mien/nn/runtime_operations.h"
#include "mien/tensor/channel_ops.h"

namespace mien {

/// What convolutional codecs need of a tensor library beyond Operations<T>, which every network needs. The
/// same form:
///
///   batch_norm(x, gamma, beta, mean, variance, eps)
///                                 each channel, with statistics that are given
///   leaky_relu(x, slope)          x where it is positive, else slope x
///   transposed_conv(x, weight, bias)
///                                 along time, stride 1, no padding: [.., N, in] -> [.., N + kernel - 1,
///                                 out]; weight [in, out, kernel] is a tensor
///   flatten_channels(x)           [.., N, D] -> [.., 1, D N], channel by channel
///   split_channels(x, channels)   its inverse: [.., 1, D N] -> [.., N, D]
template <class T>
struct ChannelOperations;

template <>
struct ChannelOperations<Tensor> {
  static Tensor batch_norm(Tensor x, const Tensor& gamma, const Tensor& beta, const Tensor& mean,
                           const Tensor& variance, double eps) {
    return mien::batch_norm(std::move(x), gamma, beta, mean, variance, eps);
  }
  static Tensor leaky_relu(Tensor x, float slope) { return mien::leaky_relu(std::move(x), slope); }
  static Tensor transposed_conv(const Tensor& x, const Tensor& weight, const Tensor& bias) {
    return transposed_conv_rows(x, weight, bias);
  }
  static Tensor flatten_channels(const Tensor& x) { return mien::flatten_channels(x); }
  static Tensor split_channels(const Tensor& x, std::int64_t channels) {
    return mien::split_channels(x, channels);
  }
};

}  // namespace mien
