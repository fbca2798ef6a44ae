#pragma once
#include <cstdint>

// Kernels over single values and single rows, compiled once per instruction set. Plain IEEE operations
// without contraction, so every instruction set, and every place of a value in its row, gives the same bits.
namespace mien::elementwise {

enum class Unary { exp, sigmoid, tanh, silu, gelu, relu, mish };
inline constexpr int kNumUnary = 7;

/// A group norm over rows and groups of neighbouring channels, with a SiLU behind it where `silu`.
struct GroupNormRows {
  const float* x = nullptr;  ///< [rows, width]
  std::int64_t rows = 0, width = 0, groups = 1;
  const float *gamma = nullptr, *beta = nullptr;  ///< [width]
  double eps = 0;
  bool silu = false;
  double* sums = nullptr;                      ///< scratch [width]
  float *means = nullptr, *factors = nullptr;  ///< scratch [width] each
  float* out = nullptr;                        ///< [rows, width]; may be x
};

/// One query against a few keys, in every head: out = softmax(q k^T) v.
struct BandRow {
  const float* q = nullptr;                 ///< [heads * width], scaled
  const float *k = nullptr, *v = nullptr;   ///< the first key and value that it sees
  std::int64_t k_stride = 0, v_stride = 0;  ///< floats from key to key
  std::int64_t heads = 1, width = 0;        ///< columns of a head
  std::int64_t count = 0;                   ///< keys, at least 1
  float* scores = nullptr;                  ///< scratch [heads * count]
  float* out = nullptr;                     ///< [heads * width]
};

struct Kernels {
  /// out[i] = f(in[i]); out may be in. Indexed by Unary.
  void (*unary[kNumUnary])(const float* in, float* out, std::int64_t count);
  /// x[i] += y[i].
  void (*add)(const float* y, std::int64_t count, float* x);
  /// out[i] = values[i] * gelu(gates[i]).
  void (*gated_gelu)(const float* values, const float* gates, std::int64_t count, float* out);
  /// out = (in - mean) / sqrt(variance + eps) * gamma + beta over one row. gamma, beta: [width]. out may be
  /// in.
  void (*layer_norm_row)(const float* in, const float* gamma, const float* beta, double eps,
                         std::int64_t width, float* out);
  /// Sums of 16 rows in float, of these in double; mean and factor of a channel rounded to float.
  void (*group_norm_rows)(const GroupNormRows& job);
  /// out = exp(in - max) / sum over one row; out may be in.
  void (*softmax_row)(const float* in, std::int64_t width, float* out);
  /// out = exp(in - max) over one row of at least one value; returns the sum. out may be in.
  float (*exp_row)(const float* in, std::int64_t width, float* out);
  void (*band_row)(const BandRow& job);
  /// out[i] = the bfloat16 nearest to in[i], ties to even; NaN stays NaN.
  void (*round_to_bfloat16)(const float* in, std::uint16_t* out, std::int64_t count);
  /// Rounds a row to 8 bits, symmetric, and returns the size of one step. NaN for a row that is not finite.
  float (*quantise_row)(const float* in, std::int64_t count, std::int8_t* out);
  /// out[i] = sums[i] * (step * steps[i]) + bias[i]; a bias of nullptr is 0.
  void (*dequantise_row)(const std::int32_t* sums, float step, const float* steps, const float* bias,
                         std::int64_t count, float* out);
  /// One row of a GRU with gates r, z, n: gi, gh [3 H] are both projections, h [H] the state before, out [H]
  /// after.
  void (*gru_row)(const float* gi, const float* gh, const float* h, std::int64_t width, float* out);
};

Kernels kernels_generic();
Kernels kernels_avx2();
Kernels kernels_avx512();

}  // namespace mien::elementwise
