#pragma once
#include <cstdint>

// Kernels over single values and single rows, compiled once per instruction set. Plain IEEE operations
// without contraction, so every instruction set, and every place of a value in its row, gives the same bits.
namespace mien::elementwise {

enum class Unary { exp, sigmoid, tanh, silu, gelu, relu, mish };
inline constexpr int kNumUnary = 7;

struct Kernels {
  /// out[i] = f(in[i]); out may be in. Indexed by Unary.
  void (*unary[kNumUnary])(const float* in, float* out, std::int64_t count);
  /// out = (in - mean) / sqrt(variance + eps) * gamma + beta over one row. gamma, beta: [width]. out may be
  /// in.
  void (*layer_norm_row)(const float* in, const float* gamma, const float* beta, double eps,
                         std::int64_t width, float* out);
  /// out = exp(in - max) / sum over one row; out may be in.
  void (*softmax_row)(const float* in, std::int64_t width, float* out);
  /// out[i] = the bfloat16 nearest to in[i], ties to even; NaN stays NaN.
  void (*round_to_bfloat16)(const float* in, std::uint16_t* out, std::int64_t count);
  /// One row of a GRU with gates r, z, n: gi, gh [3 H] are both projections, h [H] the state before, out [H]
  /// after.
  void (*gru_row)(const float* gi, const float* gh, const float* h, std::int64_t width, float* out);
};

Kernels kernels_generic();
Kernels kernels_avx2();
Kernels kernels_avx512();

}  // namespace mien::elementwise
