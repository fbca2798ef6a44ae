#pragma once
#include <cstdint>

#include "mien/tensor/tensor.h"

// What convolutional codecs need beside ops.h. The same promises: a row's bits do not depend on other rows,
// NaN passes through, shapes that do not fit are std::logic_error.
namespace mien {

/// Each channel of x [.., D] with statistics that are given: (x - mean) / sqrt(variance + eps) * gamma +
/// beta.
/// @param gamma, beta, mean, variance  [D]
Tensor batch_norm(Tensor x, const Tensor& gamma, const Tensor& beta, const Tensor& mean,
                  const Tensor& variance, double eps = 1e-5);
/// x where it is positive, else slope x.
Tensor leaky_relu(Tensor x, float slope);

/// Transposed convolution over rows, stride 1, no padding: y[n + j] += x[n] weight[:, :, j], plus bias.
/// @param x  [N, In];  weight  [In, Out, kernel], the order of PyTorch;  bias  [Out] or empty
/// @return   [N + kernel - 1, Out], no rows when x has none
Tensor transposed_conv_rows(const Tensor& x, const Tensor& weight, const Tensor& bias, int num_threads = 1);

/// Each channel of x [N, D] over its rows: (x - mean) / sqrt(variance + eps), population variance. One row
/// becomes zeros. Here a row does depend on the others.
Tensor instance_norm(Tensor x, double eps = 1e-5);

/// x [N, D] -> [N D / width, width]: channel by channel, as PyTorch flattens [D, N], cut into rows.
/// @pre width divides the values
Tensor channel_runs(const Tensor& x, std::int64_t width);
/// Its inverse: x -> [count, D]. @pre count divides the values
Tensor from_channel_runs(const Tensor& x, std::int64_t count);

/// |x[n] - table[k]|^2 as |x|^2 + |table|^2 - 2 x table: x [N, W], table [K, W] -> [N, K].
Tensor squared_distances(const Tensor& x, const Tensor& table);

}  // namespace mien
