#pragma once
#include <cstdint>
#include <span>

#include "mien/models/said/network.h"
#include "mien/nn/plain_weights.h"
#include "mien/tensor/ops.h"

namespace mien::said {

// The packed blocks of FastDenoiser. Activations are [N, width] in float32; a convolution reads them behind
// and before a row of zeros.

struct Product {
  PackedMatrix weight;
  Tensor bias;
};

/// Affine parameters of a group norm.
struct PackedGroupNorm {
  Tensor gamma, beta;
  double eps = 1e-5;
};

/// SiLU of a group norm of x [N, width], in rows 1 ... N of [N + 2, width] whose first and last row are
/// zeros.
Tensor normed_and_padded(const Tensor& x, const PackedGroupNorm& norm);

/// The same values behind and before a row of zeros.
Tensor padded(const Tensor& x);
/// A convolution of 3 taps over padded rows [N + 2, in] -> [N, out]. `bias`: [out], the convolution's own or
/// another.
Tensor convolved(const Tensor& padded_rows, const Product& conv, std::span<const float> bias);

struct FastResBlock {
  PackedGroupNorm in_norm, out_norm;
  Product in_conv, out_conv, skip;
  Tensor step_bias;  ///< [T, out]: bias of the first convolution at each step

  /// @param embeddings  of all steps, behind their SiLU [T, time]
  FastResBlock(const ResBlock<PlainWeights>& from, const Tensor& embeddings, Backend backend);
  /// x [N, in] -> [N, out]
  [[nodiscard]] Tensor run(const Tensor& x, std::int64_t step) const;
};

struct FastTransformerBlock {
  PackedGroupNorm norm;
  Tensor norm1_gamma, norm1_beta, norm2_gamma, norm2_beta, norm3_gamma, norm3_beta;
  PackedMatrix query_key_value;  ///< [3 C, C], the scale of the queries in it
  Product self_out, query, cross_out, expand;
  PackedMatrix key_value;  ///< [2 C, D] of the speech
  Product finish;          ///< [C, inner + C]: (proj_out * net.2 | proj_out)
  Tensor null_cross;       ///< [C]: what cross attention gives without speech
  std::int64_t width = 0, inner = 0, heads = 1;

  FastTransformerBlock(const TransformerBlock<PlainWeights>& from, std::span<const float> null_condition,
                       Backend backend);
  /// In front of the speech: group norm and self attention. x [N, C] -> [N, C]
  [[nodiscard]] Tensor begin(const Tensor& x) const;
  /// The rest, for y = begin(x): with keys and values of the speech [T, 2 C], or without (null).
  [[nodiscard]] Tensor end(const Tensor& x, Tensor y, const Tensor* keys_and_values,
                           std::span<const KeyRange> ranges) const;
};

}  // namespace mien::said
