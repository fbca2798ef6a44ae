#pragma once
#include <cstdint>
#include <span>

#include "mien/tensor/tensor.h"

// Operations of ops.h on memory that the caller owns, for fast paths that work block by block. Same bits, but
// for the group norm.
namespace mien {

void gelu_in_place(std::span<float> values);
/// out[i] = values[i] gelu(gates[i]). @pre equal sizes; out may be either
void gated_gelu(std::span<const float> values, std::span<const float> gates, float* out);
/// out = layer_norm(x). @param x, out  [rows, width], one after the other; out may be x
/// @pre x.size() is a multiple of the width of gamma and beta
void layer_norm_rows(std::span<const float> x, const Tensor& gamma, const Tensor& beta, double eps,
                     float* out);
/// What stands in front of a convolution or an attention.
struct GroupNormOptions {
  std::int64_t groups = 1;
  double eps = 1e-5;
  bool silu = false;  ///< a SiLU behind the norm
};
/// group_norm(x), within 1e-5 of it where the deviation is not small beside the mean: sums of 16 rows are
/// float.
/// @param x, out  [N, D]; out may be x;  gamma, beta  [D]. @pre groups divides D
void group_norm_rows(const Tensor& x, const Tensor& gamma, const Tensor& beta,
                     const GroupNormOptions& options, float* out);
/// x = layer_norm(x), or layer_norm(x + added) when `added` is given.
/// @param x  [rows, width], one after the other. @pre x.size() is a multiple of the width of gamma and beta
/// @param added  empty, or as many values as x
void layer_norm_in_place(std::span<float> x, std::span<const float> added, const Tensor& gamma,
                         const Tensor& beta, double eps = 1e-5);
/// x += y. @pre equal sizes
void add_in_place(std::span<float> x, std::span<const float> y);

}  // namespace mien
