#include <algorithm>

#include "elementwise_dispatch.h"
#include "mien/base/contract.h"
#include "mien/tensor/ops.h"
#include "require.h"

namespace mien {
namespace {

const float* checked_bias(const Tensor& bias, const PackedMatrix& w) {
  if (bias.count() == 0) return nullptr;
  require(bias.count() == w.num_outputs(), [&] {
    return "bias " + shape_text(bias.shape()) + " does not fit " + std::to_string(w.num_outputs()) +
           " outputs";
  });
  return bias.data();
}

std::int64_t unfolded_count(const Tensor& x, std::int64_t kernel, std::int64_t dilation) {
  require(x.rank() == 2, [&] { return "unfold_rows: x must be [N, D], got " + shape_text(x.shape()); });
  contract(kernel >= 1 && dilation >= 1, "unfold_rows: kernel and dilation must be at least 1");
  return std::max<std::int64_t>(0, x.size(0) - (kernel - 1) * dilation);
}

}  // namespace

Tensor linear(const Tensor& x, const PackedMatrix& w, const Tensor& bias, int num_threads) {
  contract(x.rank() >= 1, "linear: x needs an axis");
  Shape shape = x.shape();
  shape.back() = w.num_outputs();
  Tensor y = Tensor::uninitialized(std::move(shape));
  matmul(x.view(), w, checked_bias(bias, w), y.data(), num_threads);
  return y;
}

Tensor unfold_rows(const Tensor& x, std::int64_t kernel, std::int64_t dilation) {
  const std::int64_t count = unfolded_count(x, kernel, dilation), width = x.width();
  Tensor y = Tensor::uninitialized({count, kernel * width});
  float* out = y.data();
  for (std::int64_t n = 0; n < count; ++n)
    for (std::int64_t j = 0; j < kernel; ++j)
      out = std::copy_n(x.data() + (n + j * dilation) * width, width, out);
  return y;
}

Tensor conv_rows(const Tensor& x, const PackedMatrix& w, const Tensor& bias, std::int64_t kernel,
                 std::int64_t dilation, int num_threads) {
  if (kernel != 1 && dilation != 1) return linear(unfold_rows(x, kernel, dilation), w, bias, num_threads);
  // Neighbouring rows already lie one after the other: the unfolded matrix is x itself, seen with overlapping
  // rows.
  const std::int64_t count = unfolded_count(x, kernel, 1), width = x.width();
  Tensor y = Tensor::uninitialized({count, w.num_outputs()});
  matmul({x.data(), count, kernel * width, width}, w, checked_bias(bias, w), y.data(), num_threads);
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

Tensor gru_step(const Tensor& x, const Tensor& h, const PackedMatrix& w_ih, const PackedMatrix& w_hh,
                const Tensor& b_ih, const Tensor& b_hh, int num_threads) {
  return gru_step_projected(linear(x, w_ih, b_ih, num_threads), h, w_hh, b_hh, num_threads);
}

Tensor gru_step_projected(const Tensor& gi, const Tensor& h, const PackedMatrix& w_hh, const Tensor& b_hh,
                          int num_threads) {
  const std::int64_t width = h.width();
  require(w_hh.num_outputs() == 3 * width && gi.width() == 3 * width && gi.num_rows() == h.num_rows(), [&] {
    return "gru_step: projections " + shape_text(gi.shape()) + " do not fit the state " +
           shape_text(h.shape());
  });
  const Tensor gh = linear(h, w_hh, b_hh, num_threads);
  Tensor next = Tensor::uninitialized(h.shape());
  const auto& kernels = elementwise::best_kernels();
  for (std::int64_t m = 0; m < h.num_rows(); ++m)
    kernels.gru_row(gi.data() + 3 * m * width, gh.data() + 3 * m * width, h.data() + m * width, width,
                    next.data() + m * width);
  return next;
}

}  // namespace mien
