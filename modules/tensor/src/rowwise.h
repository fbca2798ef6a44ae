#pragma once
#include <cstdint>

// The product whose rows do not depend on each other. Output (m, n) is one chain of fused multiply-adds,
//   s = bias[n];  for k = 0 ... K-1:  s = fma(x[m, k], w[n, k], s)
// in this order and no other, so its bits depend on row m of x, row n of w and bias[n] alone. Speed comes
// from many chains side by side in vector registers. The instruction sets differ in the number of chains
// only.
namespace mien::rowwise {

/// Columns of a panel: the weights of 16 outputs, interleaved as [k][16]; missing outputs at the end are
/// zeros.
inline constexpr std::int64_t kPanel = 16;

/// Part of a product: `rows` rows of x times `num_panels` neighbouring panels.
struct Block {
  const float* x = nullptr;
  std::int64_t x_stride = 0;
  std::int64_t rows = 0;
  const float* panels = nullptr;  ///< [num_panels][num_inputs][kPanel], 64-byte aligned
  std::int64_t num_panels = 0;
  std::int64_t num_inputs = 0;
  const float* bias = nullptr;  ///< [num_columns] or nullptr
  float* y = nullptr;
  std::int64_t y_stride = 0;
  std::int64_t num_columns = 0;  ///< (num_panels - 1) * kPanel < num_columns <= num_panels * kPanel
};

using Multiply = void (*)(const Block&);
void multiply_generic(const Block& block);
void multiply_avx2(const Block& block);
void multiply_avx512(const Block& block);
/// x and panels hold pairs of bfloat16 in the place of floats, strides and inputs count pairs; sums are
/// float.
void multiply_avx512bf16(const Block& block);

}  // namespace mien::rowwise
