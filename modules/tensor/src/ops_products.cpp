#include <algorithm>

#include "checked_bias.h"
#include "elementwise_dispatch.h"
#include "mien/base/contract.h"
#include "mien/tensor/ops.h"
#include "require.h"

namespace mien {
Tensor linear(const Tensor& x, const PackedMatrix& w, const Tensor& bias, int num_threads) {
  contract(x.rank() >= 1, "linear: x needs an axis");
  Shape shape = x.shape();
  shape.back() = w.num_outputs();
  Tensor y = Tensor::uninitialized(std::move(shape));
  matmul(x.view(), w, checked_bias(bias, w), y.data(), num_threads);
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
