#include "mien/tensor/channel_ops.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "mien/tensor/ops.h"
#include "require.h"

namespace mien {

Tensor batch_norm(Tensor x, const Tensor& gamma, const Tensor& beta, const Tensor& mean,
                  const Tensor& variance, double eps) {
  const std::int64_t width = x.width();
  for (const Tensor* given : {&gamma, &beta, &mean, &variance})
    require(given->count() == width, [&] {
      return "batch_norm: " + shape_text(given->shape()) + " must have the width of " + shape_text(x.shape());
    });
  std::vector<double> factor(static_cast<std::size_t>(width));
  for (std::int64_t i = 0; i < width; ++i)
    factor[static_cast<std::size_t>(i)] =
        static_cast<double>(gamma.data()[i]) / std::sqrt(static_cast<double>(variance.data()[i]) + eps);
  float* p = x.data();
  for (std::int64_t r = 0; r < x.num_rows(); ++r, p += width)
    for (std::int64_t i = 0; i < width; ++i) {
      const double centred = static_cast<double>(p[i]) - static_cast<double>(mean.data()[i]);
      p[i] = static_cast<float>(centred * factor[static_cast<std::size_t>(i)] +
                                static_cast<double>(beta.data()[i]));
    }
  return x;
}

Tensor leaky_relu(Tensor x, float slope) {
  for (float& value : x.values()) value = value > 0 ? value : value * slope;
  return x;
}

Tensor transposed_conv_rows(const Tensor& x, const Tensor& weight, const Tensor& bias, int num_threads) {
  require(x.rank() == 2 && weight.rank() == 3 && weight.size(0) == x.width(), [&] {
    return "transposed_conv_rows: x " + shape_text(x.shape()) + " does not fit the weights " +
           shape_text(weight.shape());
  });
  const std::int64_t inputs = weight.size(0), outputs = weight.size(1), kernel = weight.size(2);
  if (x.num_rows() == 0) return Tensor({0, outputs});
  // The same as a convolution of x between kernel - 1 rows of zeros, with the taps in reverse.
  Tensor taps = Tensor::uninitialized({outputs, kernel * inputs});
  for (std::int64_t o = 0; o < outputs; ++o)
    for (std::int64_t j = 0; j < kernel; ++j)
      for (std::int64_t i = 0; i < inputs; ++i)
        taps.data()[(o * kernel + j) * inputs + i] =
            weight.data()[(i * outputs + o) * kernel + kernel - 1 - j];
  Tensor padded({x.num_rows() + 2 * (kernel - 1), inputs});
  std::ranges::copy(x.values(), padded.data() + (kernel - 1) * inputs);
  return conv_rows(padded, PackedMatrix(taps), bias, kernel, 1, 1, num_threads);
}

Tensor flatten_channels(const Tensor& x) {
  require(x.rank() == 2, [&] { return "flatten_channels: x must be [N, D], got " + shape_text(x.shape()); });
  const std::int64_t count = x.num_rows(), width = x.width();
  Tensor y = Tensor::uninitialized({1, x.count()});
  for (std::int64_t n = 0; n < count; ++n)
    for (std::int64_t c = 0; c < width; ++c) y.data()[c * count + n] = x.data()[n * width + c];
  return y;
}

Tensor split_channels(const Tensor& x, std::int64_t channels) {
  require(x.num_rows() == 1 && channels >= 1 && x.count() % channels == 0, [&] {
    return "split_channels: " + shape_text(x.shape()) + " is no row of " + std::to_string(channels) +
           " channels";
  });
  const std::int64_t count = x.count() / channels;
  Tensor y = Tensor::uninitialized({count, channels});
  for (std::int64_t n = 0; n < count; ++n)
    for (std::int64_t c = 0; c < channels; ++c) y.data()[n * channels + c] = x.data()[c * count + n];
  return y;
}

}  // namespace mien
