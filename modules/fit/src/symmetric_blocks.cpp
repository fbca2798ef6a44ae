#include "symmetric_blocks.h"

#include <cstring>

#include "wide_vectors.h"

namespace mien {
namespace {

#define MIEN_INLINE inline __attribute__((always_inline))

// Eight numbers, whatever the width of the machine's vectors; the same bits on all.
typedef double Eight __attribute__((vector_size(kBlock * sizeof(double)), aligned(sizeof(double))));

MIEN_INLINE double sum(const Eight& v) {
  return ((v[0] + v[1]) + (v[2] + v[3])) + ((v[4] + v[5]) + (v[6] + v[7]));
}
MIEN_INLINE Eight* rows(double* block) { return reinterpret_cast<Eight*>(block); }
MIEN_INLINE const Eight* rows(const double* block) { return reinterpret_cast<const Eight*>(block); }

// e [8, 8] becomes its inverse, by Gauss-Jordan elimination.
MIEN_INLINE bool invert_eight(double* e) {
  Eight m[kBlock];
  std::memcpy(m, e, sizeof(m));
  for (std::int64_t p = 0; p < kBlock; ++p) {
    const double pivot = m[p][p];
    if (!(pivot > 0)) return false;  // NaN too
    m[p][p] = 1;
    m[p] /= pivot;
    for (std::int64_t i = 0; i < kBlock; ++i) {
      if (i == p) continue;
      const double factor = m[i][p];
      m[i][p] = 0;
      m[i] -= factor * m[p];
    }
  }
  std::memcpy(e, m, sizeof(m));
  return true;
}

MIEN_INLINE void transpose(const double* from, double* to) {
  for (std::int64_t r = 0; r < kBlock; ++r)
    for (std::int64_t c = 0; c < kBlock; ++c) to[c * kBlock + r] = from[r * kBlock + c];
}

// to -= u v^T for blocks u and v that are stored row by row and column by column.
MIEN_INLINE void subtract_product(const double* u, const double* v_columns, double* to) {
  Eight sums[kBlock];
  std::memcpy(sums, to, sizeof(sums));
  for (std::int64_t c = 0; c < kBlock; ++c) {
    const Eight v = rows(v_columns)[c];
    for (std::int64_t r = 0; r < kBlock; ++r) sums[r] -= u[r * kBlock + c] * v;
  }
  std::memcpy(to, sums, sizeof(sums));
}

}  // namespace

// The sweep operator by blocks: sweeping S turns [S, R] into [-A_SS^-1, A_SS^-1 A_SR; ., A_RR - A_RS A_SS^-1
// A_SR]; when every block is swept, the matrix is -A^-1.
MIEN_WIDE_VECTORS bool invert_blocks(double* a, std::int64_t num_blocks, double* scratch) {
  constexpr std::int64_t kSize = kBlock * kBlock;
  double* columns = scratch;                     // A_RS, each block transposed
  double* swept = scratch + num_blocks * kSize;  // A_RS A_SS^-1
  for (std::int64_t s = 0; s < num_blocks; ++s) {
    double* pivot = a + block_offset(s, s);
    if (!invert_eight(pivot)) return false;
    for (std::int64_t i = 0; i < num_blocks; ++i) {
      if (i == s) continue;
      double plain[kSize];
      if (i > s) {
        std::memcpy(plain, a + block_offset(i, s), sizeof(plain));
        transpose(plain, columns + i * kSize);
      } else {
        std::memcpy(columns + i * kSize, a + block_offset(s, i), sizeof(plain));
        transpose(columns + i * kSize, plain);
      }
      Eight products[kBlock] = {};
      for (std::int64_t c = 0; c < kBlock; ++c) {
        const Eight e = rows(pivot)[c];
        for (std::int64_t r = 0; r < kBlock; ++r) products[r] += plain[r * kBlock + c] * e;
      }
      std::memcpy(swept + i * kSize, products, sizeof(products));
    }
    for (std::int64_t i = 0; i < num_blocks; ++i) {
      if (i == s) continue;
      for (std::int64_t j = 0; j <= i; ++j)
        if (j != s) subtract_product(swept + i * kSize, columns + j * kSize, a + block_offset(i, j));
      if (i > s) std::memcpy(a + block_offset(i, s), swept + i * kSize, kSize * sizeof(double));
      if (i < s) transpose(swept + i * kSize, a + block_offset(s, i));
    }
    for (std::int64_t r = 0; r < kBlock; ++r) rows(pivot)[r] = -rows(pivot)[r];
  }
  const std::int64_t count = block_offset(num_blocks, 0);
  for (std::int64_t i = 0; i < count; ++i) a[i] = -a[i];
  return true;
}

namespace {

template <bool kDiagonal>
MIEN_INLINE void multiply(const double* a, std::int64_t num_blocks, const double* x, double* y) {
  for (std::int64_t i = 0; i < num_blocks; ++i) rows(y)[i] = Eight{};
  for (std::int64_t i = 0; i < num_blocks; ++i) {
    const double* xi = x + i * kBlock;
    Eight sums[kBlock] = {};
    for (std::int64_t j = 0; j < i; ++j, a += kBlock * kBlock) {
      const Eight xj = rows(x)[j];
      Eight yj = rows(y)[j];
      for (std::int64_t r = 0; r < kBlock; ++r) {
        const Eight row = rows(a)[r];
        sums[r] += row * xj;
        yj += row * xi[r];
      }
      rows(y)[j] = yj;
    }
    for (std::int64_t r = 0; r < kBlock; ++r) {
      Eight row = rows(a)[r];
      if (!kDiagonal) row[r] = 0;
      sums[r] += row * rows(x)[i];
      y[i * kBlock + r] += sum(sums[r]);
    }
    a += kBlock * kBlock;
  }
}

}  // namespace

MIEN_WIDE_VECTORS void multiply_blocks(const double* a, std::int64_t num_blocks, const double* x, double* y) {
  multiply<true>(a, num_blocks, x, y);
}
MIEN_WIDE_VECTORS void multiply_off_diagonal(const double* a, std::int64_t num_blocks, const double* x,
                                             double* y) {
  multiply<false>(a, num_blocks, x, y);
}

MIEN_WIDE_VECTORS void couple_blocks(const double* p, const double* a, const double* m, const double* w,
                                     std::int64_t num_blocks, double* next, double* sums) {
  for (std::int64_t i = 0; i < num_blocks; ++i) rows(sums)[i] = Eight{};
  for (std::int64_t i = 0; i < num_blocks; ++i) {
    Eight row_sums[kBlock] = {};
    for (std::int64_t j = 0; j <= i; ++j) {
      const std::int64_t at = block_offset(i, j);
      const Eight wj = rows(w)[j];
      Eight column_sum = {};
      for (std::int64_t r = 0; r < kBlock; ++r) {
        const Eight mr = rows(m + at)[r], product = rows(a + at)[r] * mr;
        row_sums[r] += product;
        if (j < i) column_sum += product;
        rows(next + at)[r] = rows(p + at)[r] - w[i * kBlock + r] * mr * wj;
      }
      rows(sums)[j] += column_sum;
    }
    for (std::int64_t r = 0; r < kBlock; ++r) sums[i * kBlock + r] += sum(row_sums[r]);
  }
  for (std::int64_t i = 0; i < num_blocks; ++i)
    for (std::int64_t r = 0; r < kBlock; ++r) {
      const std::int64_t at = block_offset(i, i) + r * kBlock + r;
      next[at] = p[at] + w[i * kBlock + r] * sums[i * kBlock + r];
    }
}

}  // namespace mien
