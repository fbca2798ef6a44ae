#include "mien/tensor/channel_ops.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <utility>
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

Tensor instance_norm(Tensor x, double eps) {
  Tensor ones({x.width()});
  std::ranges::fill(ones.values(), 1.0f);
  return group_norm(std::move(x), ones, Tensor({ones.count()}), ones.count(), eps);
}

Tensor channel_runs(const Tensor& x, std::int64_t width) {
  require(width >= 1 && x.count() % width == 0, [&] {
    return "channel_runs: " + shape_text(x.shape()) + " is not whole rows of " + std::to_string(width);
  });
  return transposed(x).reshaped({x.count() / width, width});
}

Tensor from_channel_runs(const Tensor& x, std::int64_t count) {
  require(count >= 1 && x.count() % count == 0, [&] {
    return "from_channel_runs: " + shape_text(x.shape()) + " is not whole channels of " +
           std::to_string(count);
  });
  return transposed(x.reshaped({x.count() / count, count}));
}

Tensor squared_distances(const Tensor& x, const Tensor& table) {
  require(x.width() == table.width(), [&] {
    return "squared_distances: widths of " + shape_text(x.shape()) + " and " + shape_text(table.shape()) +
           " differ";
  });
  const auto square_of = [](std::span<const float> row) {
    double sum = 0;
    for (const float v : row) sum += static_cast<double>(v) * v;
    return sum;
  };
  std::vector<double> of_table;
  for (std::int64_t k = 0; k < table.num_rows(); ++k) of_table.push_back(square_of(table.row(k)));
  Tensor out = linear(x, PackedMatrix(table));
  for (std::int64_t n = 0; n < out.num_rows(); ++n) {
    const double own = square_of(x.row(n));
    const auto row = out.row(n);
    for (std::size_t k = 0; k < row.size(); ++k)
      row[k] = static_cast<float>(own + of_table[k] - 2.0 * static_cast<double>(row[k]));
  }
  return out;
}

}  // namespace mien
