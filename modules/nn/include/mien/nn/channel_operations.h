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
///   instance_norm(x, eps)         each channel over all its rows, without gamma and beta
///   channel_runs(x, width)        x channel by channel, cut into rows: [.., N, D] -> [.., N D / width,
///   width] from_channel_runs(x, count)   its inverse: [.., N D / width, width] -> [.., count, D]
///   squared_distances(x, table)   of rows [.., N, W] to rows of a table [K, W] -> [.., N, K]
///   straight_through(x, y)        x + (y - x), whose gradient is that of x
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
  static Tensor instance_norm(Tensor x, double eps) { return mien::instance_norm(std::move(x), eps); }
  static Tensor channel_runs(const Tensor& x, std::int64_t width) { return mien::channel_runs(x, width); }
  static Tensor from_channel_runs(const Tensor& x, std::int64_t count) {
    return mien::from_channel_runs(x, count);
  }
  static Tensor squared_distances(const Tensor& x, const Tensor& table) {
    return mien::squared_distances(x, table);
  }
  static Tensor straight_through(const Tensor& x, const Tensor& y) { return add(x, sub(y, x)); }
};

}  // namespace mien
