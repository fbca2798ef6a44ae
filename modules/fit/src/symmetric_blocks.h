#pragma once
#include <cstdint>

// Symmetric matrices as the 8 x 8 blocks of their lower half, row of blocks after row of blocks, each block
// row-major; the blocks on the diagonal are whole. Sizes that are no multiple of 8 are padded.
namespace mien {

inline constexpr std::int64_t kBlock = 8;

/// Where block (i, j), j <= i, begins.
inline constexpr std::int64_t block_offset(std::int64_t i, std::int64_t j) {
  return (i * (i + 1) / 2 + j) * kBlock * kBlock;
}

/// a becomes its inverse. False when a is not positive definite or not finite.
/// @param scratch  [2, 8 num_blocks, 8]
[[nodiscard]] bool invert_blocks(double* a, std::int64_t num_blocks, double* scratch);

/// y = a x.
void multiply_blocks(const double* a, std::int64_t num_blocks, const double* x, double* y);
/// y = a x without the diagonal of a.
void multiply_off_diagonal(const double* a, std::int64_t num_blocks, const double* x, double* y);

/// next = p - diag(w) m diag(w), but with w_i (sum over j of a_ij m_ij) on the diagonal instead of -w_i^2
/// m_ii: the same number plus w_i when m = (a + diag(w))^-1, without its loss of digits where w is huge.
/// @param sums  [8 num_blocks] scratch
void couple_blocks(const double* p, const double* a, const double* m, const double* w,
                   std::int64_t num_blocks, double* next, double* sums);

}  // namespace mien
