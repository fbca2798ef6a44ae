#include <algorithm>
#include <cmath>

#include "checked_bias.h"
#include "mien/base/contract.h"
#include "mien/base/parallel.h"
#include "mien/tensor/ops.h"
#include "require.h"

namespace mien {
namespace {

std::int64_t unfolded_count(const Tensor& x, std::int64_t kernel, std::int64_t dilation,
                            std::int64_t stride) {
  require(x.rank() == 2, [&] { return "unfold_rows: x must be [N, D], got " + shape_text(x.shape()); });
  contract(kernel >= 1 && dilation >= 1 && stride >= 1,
           "unfold_rows: kernel, dilation and stride must be at least 1");
  const std::int64_t last = x.size(0) - (kernel - 1) * dilation - 1;  // where the last window may start
  return last < 0 ? 0 : last / stride + 1;
}

}  // namespace

Tensor unfold_rows(const Tensor& x, std::int64_t kernel, std::int64_t dilation) {
  const std::int64_t count = unfolded_count(x, kernel, dilation, 1), width = x.width();
  Tensor y = Tensor::uninitialized({count, kernel * width});
  float* out = y.data();
  for (std::int64_t n = 0; n < count; ++n)
    for (std::int64_t j = 0; j < kernel; ++j)
      out = std::copy_n(x.data() + (n + j * dilation) * width, width, out);
  return y;
}

Tensor conv_rows(const Tensor& x, const PackedMatrix& w, const Tensor& bias, std::int64_t kernel,
                 std::int64_t dilation, std::int64_t stride, int num_threads) {
  if (kernel != 1 && dilation != 1) {
    contract(stride == 1, "conv_rows: a dilated convolution has stride 1");
    return linear(unfold_rows(x, kernel, dilation), w, bias, num_threads);
  }
  // Neighbouring rows already lie one after the other: the unfolded matrix is x itself, seen with overlapping
  // rows.
  const std::int64_t count = unfolded_count(x, kernel, 1, stride), width = x.width();
  Tensor y = Tensor::uninitialized({count, w.num_outputs()});
  matmul({x.data(), count, kernel * width, stride * width}, w, checked_bias(bias, w), y.data(), num_threads);
  return y;
}

Tensor tap_major(const Tensor& weight) {
  require(weight.rank() == 3,
          [&] { return "tap_major: weight must be [Out, In, kernel], got " + shape_text(weight.shape()); });
  const std::int64_t outputs = weight.size(0), inputs = weight.size(1), kernel = weight.size(2);
  Tensor y = Tensor::uninitialized({outputs, kernel * inputs});
  for (std::int64_t o = 0; o < outputs; ++o)
    for (std::int64_t i = 0; i < inputs; ++i)
      for (std::int64_t j = 0; j < kernel; ++j)
        y.data()[(o * kernel + j) * inputs + i] = weight.data()[(o * inputs + i) * kernel + j];
  return y;
}

PackedGroups pack_groups(const Tensor& weight, std::int64_t groups, Backend backend) {
  require(weight.rank() == 3 && groups >= 1 && weight.size(0) % groups == 0, [&] {
    return "pack_groups: " + std::to_string(groups) + " groups do not divide the weights " +
           shape_text(weight.shape());
  });
  PackedGroups packed{weight.size(2), weight.size(1), weight.size(0) / groups, {}};
  const Tensor taps = tap_major(weight);
  const std::int64_t size = packed.outputs * taps.width();
  for (std::int64_t g = 0; g < groups; ++g)
    packed.groups.emplace_back(
        taps.values().subspan(static_cast<std::size_t>(g * size), static_cast<std::size_t>(size)),
        packed.outputs, taps.width(), backend);
  return packed;
}

Tensor grouped_conv_rows(const Tensor& x, const PackedGroups& w, const Tensor& bias, std::int64_t before,
                         std::int64_t after, int num_threads) {
  const auto num_groups = static_cast<std::int64_t>(w.groups.size());
  require(x.rank() == 2 && x.width() == num_groups * w.inputs, [&] {
    return "grouped_conv_rows: x " + shape_text(x.shape()) + " does not fit " + std::to_string(num_groups) +
           " groups of " + std::to_string(w.inputs) + " channels";
  });
  contract(bias.count() == 0 || bias.count() == num_groups * w.outputs,
           "grouped_conv_rows: bias of another size");
  const std::int64_t padded = x.num_rows() + before + after;
  const std::int64_t count = std::max<std::int64_t>(0, padded - w.kernel + 1);
  Tensor y = Tensor::uninitialized({count, num_groups * w.outputs});
  if (count == 0) return y;
  // A group's channels side by side make its window one run of numbers, as in conv_rows().
  parallel_for(num_threads, num_groups, [&](std::int64_t g) {
    Tensor in({padded, w.inputs});
    for (std::int64_t t = 0; t < x.num_rows(); ++t)
      std::copy_n(x.data() + t * x.width() + g * w.inputs, w.inputs, in.data() + (before + t) * w.inputs);
    Tensor out = Tensor::uninitialized({count, w.outputs});
    matmul({in.data(), count, w.kernel * w.inputs, w.inputs}, w.groups[static_cast<std::size_t>(g)],
           bias.count() == 0 ? nullptr : bias.data() + g * w.outputs, out.data());
    for (std::int64_t t = 0; t < count; ++t)
      std::copy_n(out.data() + t * w.outputs, w.outputs, y.data() + t * y.width() + g * w.outputs);
  });
  return y;
}

Tensor weight_norm_taps(const Tensor& v, const Tensor& g) {
  require(v.rank() == 3 && g.count() == v.width(), [&] {
    return "weight_norm_taps: g " + shape_text(g.shape()) + " does not fit v " + shape_text(v.shape());
  });
  const std::int64_t kernel = v.width();
  std::vector<double> factor(static_cast<std::size_t>(kernel));
  for (std::int64_t i = 0; i < v.count(); ++i) {
    const double value = v.data()[i];
    factor[static_cast<std::size_t>(i % kernel)] += value * value;
  }
  for (std::int64_t k = 0; k < kernel; ++k) {
    double& f = factor[static_cast<std::size_t>(k)];
    f = static_cast<double>(g.data()[k]) / std::sqrt(f);
  }
  Tensor w = Tensor::uninitialized(v.shape());
  for (std::int64_t i = 0; i < v.count(); ++i)
    w.data()[i] = static_cast<float>(v.data()[i] * factor[static_cast<std::size_t>(i % kernel)]);
  return w;
}

}  // namespace mien
