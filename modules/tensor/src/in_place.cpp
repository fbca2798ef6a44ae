#include "mien/tensor/in_place.h"

#include "elementwise_dispatch.h"
#include "mien/base/contract.h"

namespace mien {

void gelu_in_place(std::span<float> values) {
  elementwise::best_kernels().unary[static_cast<int>(elementwise::Unary::gelu)](
      values.data(), values.data(), static_cast<std::int64_t>(values.size()));
}

void silu_in_place(std::span<float> values) {
  elementwise::best_kernels().unary[static_cast<int>(elementwise::Unary::silu)](
      values.data(), values.data(), static_cast<std::int64_t>(values.size()));
}

void add_in_place(std::span<float> x, std::span<const float> y) {
  contract(x.size() == y.size(), "add_in_place: sizes differ");
  for (std::size_t i = 0; i < x.size(); ++i) x[i] += y[i];
}

void layer_norm_in_place(std::span<float> x, std::span<const float> added, const Tensor& gamma,
                         const Tensor& beta, double eps) {
  const std::int64_t width = gamma.count();
  contract(width > 0 && beta.count() == width && static_cast<std::int64_t>(x.size()) % width == 0,
           "layer_norm_in_place: gamma and beta must have the width of the rows");
  if (!added.empty()) add_in_place(x, added);
  const auto& kernels = elementwise::best_kernels();
  for (float* row = x.data(); row != x.data() + x.size(); row += width)
    kernels.layer_norm_row(row, gamma.data(), beta.data(), eps, width, row);
}

}  // namespace mien
