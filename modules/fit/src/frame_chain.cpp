#include "frame_chain.h"

#include <algorithm>

#include "mien/base/contract.h"
#include "wide_vectors.h"

namespace mien {
namespace {

constexpr std::int64_t kLanes = 8;  // rows are padded to whole groups of these

// Makes one row the pivot's, within its own block of rows.
inline __attribute__((always_inline)) bool scale_pivot(double* row, std::int64_t pivot, std::int64_t stride) {
  if (!(row[pivot] > 0)) return false;  // NaN too
  const double inverse = 1 / row[pivot];
  row[pivot] = 1;
  for (std::int64_t j = 0; j < stride; ++j) row[j] *= inverse;
  return true;
}

inline __attribute__((always_inline)) void eliminate(double* row, const double* pivot_row, std::int64_t pivot,
                                                     std::int64_t stride) {
  const double factor = row[pivot];
  row[pivot] = 0;
  for (std::int64_t j = 0; j < stride; ++j) row[j] -= factor * pivot_row[j];
}

// row -= sum of factors[b] * pivot_rows[b]: four pivots in one pass over the row.
inline __attribute__((always_inline)) void eliminate_four(double* a, std::int64_t num_rows,
                                                          std::int64_t stride, std::int64_t first) {
  const double *p0 = a + first * stride, *p1 = p0 + stride, *p2 = p1 + stride, *p3 = p2 + stride;
  for (std::int64_t i = 0; i < num_rows; ++i) {
    if (i == first) i += 4;
    if (i >= num_rows) break;
    double* row = a + i * stride;
    const double f0 = row[first], f1 = row[first + 1], f2 = row[first + 2], f3 = row[first + 3];
    row[first] = row[first + 1] = row[first + 2] = row[first + 3] = 0;
    for (std::int64_t j = 0; j < stride; ++j) row[j] -= (f0 * p0[j] + f1 * p1[j]) + (f2 * p2[j] + f3 * p3[j]);
  }
}

// y += M x for a packed lower triangle of a symmetric M. Sums run in eight lanes, so that they are vectors.
MIEN_WIDE_VECTORS void multiply_packed(const double* packed, std::int64_t k, const double* x, double* y) {
  for (std::int64_t i = 0; i < k; packed += ++i) {
    const double xi = x[i];
    double lanes[kLanes] = {};
    std::int64_t j = 0;
    for (; j + kLanes <= i; j += kLanes)
      for (std::int64_t l = 0; l < kLanes; ++l) {
        lanes[l] += packed[j + l] * x[j + l];
        y[j + l] += packed[j + l] * xi;
      }
    double sum = packed[i] * xi;
    for (; j < i; ++j) {
      sum += packed[j] * x[j];
      y[j] += packed[j] * xi;
    }
    for (const double lane : lanes) sum += lane;
    y[i] += sum;
  }
}

}  // namespace

MIEN_WIDE_VECTORS bool invert(double* a, std::int64_t num_rows, std::int64_t stride) {
  std::int64_t first = 0;
  for (; first + 4 <= num_rows; first += 4) {
    // The four pivots among themselves, then all other rows.
    for (std::int64_t p = first; p < first + 4; ++p) {
      if (!scale_pivot(a + p * stride, p, stride)) return false;
      for (std::int64_t i = first; i < first + 4; ++i)
        if (i != p) eliminate(a + i * stride, a + p * stride, p, stride);
    }
    eliminate_four(a, num_rows, stride, first);
  }
  for (; first < num_rows; ++first) {
    if (!scale_pivot(a + first * stride, first, stride)) return false;
    for (std::int64_t i = 0; i < num_rows; ++i)
      if (i != first) eliminate(a + i * stride, a + first * stride, first, stride);
  }
  return true;
}

FrameChain::FrameChain(std::span<const double> quadratic, std::int64_t num_channels, std::int64_t num_frames)
    : num_channels_(num_channels),
      num_frames_(num_frames),
      stride_((num_channels + kLanes - 1) / kLanes * kLanes) {
  contract(static_cast<std::int64_t>(quadratic.size()) == num_channels * num_channels,
           "FrameChain: quadratic must be [K, K]");
  quadratic_.resize(static_cast<std::size_t>(num_channels_ * stride_));
  for (std::int64_t i = 0; i < num_channels_; ++i)
    std::copy_n(quadratic.data() + i * num_channels_, num_channels_, quadratic_.data() + i * stride_);
  inverses_.resize(static_cast<std::size_t>(num_frames_ * num_channels_ * (num_channels_ + 1) / 2));
  frames_.resize(inverses_.size());
}

bool FrameChain::factor(std::span<const double> d, std::span<const double> w) {
  coupling_.assign(w.begin(), w.end());
  const std::int64_t k = num_channels_, triangle = k * (k + 1) / 2;
  // A_n = P + diag(d_n) + C_{n-1}, where C is what the frames before leave: W - W (A + W)^-1 W. Its diagonal
  // is computed as w_i sum over j of A_ij (A + W)^-1_ji, which is the same and does not lose all digits when
  // w is huge.
  std::vector<double> frame = quadratic_, inverse(quadratic_.size());
  for (std::int64_t n = 0; n < num_frames_; ++n) {
    const double* after = n + 1 < num_frames_ ? coupling_.data() + n * k : nullptr;
    for (std::int64_t i = 0; i < k; ++i) frame[i * stride_ + i] += d[static_cast<std::size_t>(n * k + i)];
    inverse = frame;
    if (after)
      for (std::int64_t i = 0; i < k; ++i) inverse[i * stride_ + i] += after[i];
    if (!invert(inverse.data(), k, stride_)) return false;
    double *packed_inverse = inverses_.data() + n * triangle, *packed_frame = frames_.data() + n * triangle;
    for (std::int64_t i = 0; i < k; ++i) {
      packed_inverse = std::copy_n(inverse.data() + i * stride_, i + 1, packed_inverse);
      packed_frame = std::copy_n(frame.data() + i * stride_, i + 1, packed_frame);
    }
    if (!after) break;
    for (std::int64_t i = 0; i < k; ++i) {
      double* a = frame.data() + i * stride_;
      const double* m = inverse.data() + i * stride_;
      const double* p = quadratic_.data() + i * stride_;
      double diagonal = 0;
      for (std::int64_t j = 0; j < k; ++j) diagonal += a[j] * m[j];
      for (std::int64_t j = 0; j < k; ++j) a[j] = p[j] - after[i] * m[j] * after[j];
      a[i] = p[i] + after[i] * diagonal;
    }
  }
  return true;
}

void FrameChain::solve(std::span<double> x, std::span<double> change) const {
  const std::int64_t k = num_channels_;
  std::vector<double> product(static_cast<std::size_t>(k));
  for (std::int64_t n = 0; n + 1 < num_frames_; ++n) {
    std::fill(product.begin(), product.end(), 0.0);
    multiply_packed(packed(inverses_, n), k, x.data() + n * k, product.data());
    const double* w = coupling_.data() + n * k;
    double* after = x.data() + (n + 1) * k;
    for (std::int64_t i = 0; i < k; ++i) after[i] += w[i] * product[static_cast<std::size_t>(i)];
  }
  if (num_frames_ > 0) {
    double* last = x.data() + (num_frames_ - 1) * k;
    std::fill(product.begin(), product.end(), 0.0);
    multiply_packed(packed(inverses_, num_frames_ - 1), k, last, product.data());
    std::copy(product.begin(), product.end(), last);
  }
  // From (A + W) x_n = y + W x_{n+1}: x_{n+1} - x_n = (A + W)^-1 (A x_{n+1} - y).
  for (std::int64_t n = num_frames_ - 1; n-- > 0;) {
    double *here = x.data() + n * k, *step = change.data() + n * k;
    const double* after = here + k;
    for (std::int64_t i = 0; i < k; ++i) product[static_cast<std::size_t>(i)] = -here[i];
    multiply_packed(packed(frames_, n), k, after, product.data());
    std::fill_n(step, k, 0.0);
    multiply_packed(packed(inverses_, n), k, product.data(), step);
    for (std::int64_t i = 0; i < k; ++i) here[i] = after[i] - step[i];
  }
}

}  // namespace mien
