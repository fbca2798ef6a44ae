#include "mien/tensor/in_place.h"

#include <vector>

#include "elementwise_dispatch.h"
#include "mien/base/contract.h"

namespace mien {

void gelu_in_place(std::span<float> values) {
  elementwise::best_kernels().unary[static_cast<int>(elementwise::Unary::gelu)](
      values.data(), values.data(), static_cast<std::int64_t>(values.size()));
}

void add_in_place(std::span<float> x, std::span<const float> y) {
  contract(x.size() == y.size(), "add_in_place: sizes differ");
  elementwise::best_kernels().add(y.data(), static_cast<std::int64_t>(y.size()), x.data());
}

void gated_gelu(std::span<const float> values, std::span<const float> gates, float* out) {
  contract(values.size() == gates.size(), "gated_gelu: sizes differ");
  elementwise::best_kernels().gated_gelu(values.data(), gates.data(),
                                         static_cast<std::int64_t>(values.size()), out);
}

void layer_norm_rows(std::span<const float> x, const Tensor& gamma, const Tensor& beta, double eps,
                     float* out) {
  const std::int64_t width = gamma.count();
  contract(width > 0 && beta.count() == width && static_cast<std::int64_t>(x.size()) % width == 0,
           "layer_norm_rows: gamma and beta must have the width of the rows");
  const auto& kernels = elementwise::best_kernels();
  for (const float* row = x.data(); row != x.data() + x.size(); row += width, out += width)
    kernels.layer_norm_row(row, gamma.data(), beta.data(), eps, width, out);
}

void group_norm_rows(const Tensor& x, const Tensor& gamma, const Tensor& beta,
                     const GroupNormOptions& options, float* out) {
  const std::int64_t width = x.width();
  contract(
      gamma.count() == width && beta.count() == width && options.groups >= 1 && width % options.groups == 0,
      "group_norm_rows: gamma, beta and groups must fit the width of the rows");
  std::vector<double> sums(static_cast<std::size_t>(width));
  AlignedFloats means(width), factors(width);
  elementwise::best_kernels().group_norm_rows({.x = x.data(),
                                               .rows = x.num_rows(),
                                               .width = width,
                                               .groups = options.groups,
                                               .gamma = gamma.data(),
                                               .beta = beta.data(),
                                               .eps = options.eps,
                                               .silu = options.silu,
                                               .sums = sums.data(),
                                               .means = means.get(),
                                               .factors = factors.get(),
                                               .out = out});
}

void layer_norm_in_place(std::span<float> x, std::span<const float> added, const Tensor& gamma,
                         const Tensor& beta, double eps) {
  if (!added.empty()) add_in_place(x, added);
  layer_norm_rows(x, gamma, beta, eps, x.data());
}

}  // namespace mien
