#include "gaussian_factor.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "mien/base/parallel.h"

namespace mien::facediffuser {
namespace {

// W W^T, from its lower half: blocks of rows, each times the blocks up to it. Products of some columns at a
// time in float32, added up in double: D is large.
std::vector<double> gram(const PackedMatrix& w, int num_threads) {
  constexpr std::int64_t kColumns = 2048, kRows = 128;
  const std::int64_t size = w.num_outputs(), num_blocks = (size + kRows - 1) / kRows;
  std::vector<std::pair<std::int64_t, std::int64_t>> pairs;
  for (std::int64_t i = 0; i < num_blocks; ++i)
    for (std::int64_t j = 0; j <= i; ++j) pairs.emplace_back(i * kRows, j * kRows);
  std::vector<double> sum(static_cast<std::size_t>(size * size));
  for (std::int64_t first = 0; first < w.num_inputs(); first += kColumns) {
    const Tensor part = w.unpacked(first, std::min(kColumns, w.num_inputs() - first));
    const auto block = [&](std::int64_t row) { return rows(part, row, std::min(kRows, size - row)); };
    std::vector<PackedMatrix> packed(static_cast<std::size_t>(num_blocks));
    parallel_for(num_threads, num_blocks, [&](std::int64_t i) {
      packed[static_cast<std::size_t>(i)] = PackedMatrix(block(i * kRows));
    });
    parallel_for(num_threads, static_cast<std::int64_t>(pairs.size()), [&](std::int64_t p) {
      const auto [row, column] = pairs[static_cast<std::size_t>(p)];
      const Tensor product = linear(block(row), packed[static_cast<std::size_t>(column / kRows)]);
      for (std::int64_t r = 0; r < product.num_rows(); ++r)
        for (std::int64_t c = 0; c < product.width(); ++c)
          sum[static_cast<std::size_t>((row + r) * size + column + c)] +=
              static_cast<double>(product.data()[r * product.width() + c]);
    });
  }
  for (std::int64_t r = 0; r < size; ++r)
    for (std::int64_t c = r + 1; c < size; ++c)
      sum[static_cast<std::size_t>(r * size + c)] = sum[static_cast<std::size_t>(c * size + r)];
  return sum;
}

// Each row of a [size, size] filtered along itself, then turned over.
std::vector<double> filtered_transposed(const std::vector<double>& a, std::int64_t size, const Tensor& taps) {
  const std::int64_t num_taps = taps.count(), reach = num_taps / 2;
  std::vector<double> out(a.size());
  for (std::int64_t r = 0; r < size; ++r)
    for (std::int64_t i = 0; i < size; ++i) {
      double sum = 0;
      for (std::int64_t j = std::max<std::int64_t>(0, reach - i); j < std::min(num_taps, size + reach - i);
           ++j)
        sum += static_cast<double>(taps.data()[j]) * a[static_cast<std::size_t>(r * size + i + j - reach)];
      out[static_cast<std::size_t>(i * size + r)] = sum;
    }
  return out;
}

}  // namespace

Tensor gaussian_factor(const PackedMatrix& weights, const Tensor& taps, int num_threads) {
  const std::int64_t size = weights.num_outputs();
  // A A^T = F (W W^T) F^T: filter rows and columns.
  std::vector<double> u =
      filtered_transposed(filtered_transposed(gram(weights, num_threads), size, taps), size, taps);
  double trace = 0;
  for (std::int64_t i = 0; i < size; ++i) trace += u[static_cast<std::size_t>(i * size + i)];
  const double least = 1e-7 * trace / static_cast<double>(std::max<std::int64_t>(size, 1));
  // Cholesky by rows of the upper factor U: A A^T = U^T U, C = U^T.
  for (std::int64_t k = 0; k < size; ++k) {
    double* row = u.data() + k * size;
    const double pivot = row[k];
    const double scale = pivot > least ? 1 / std::sqrt(pivot) : 0.0;
    for (std::int64_t j = k; j < size; ++j) row[j] *= scale;
    for (std::int64_t i = k + 1; i < size; ++i) {
      double* below = u.data() + i * size;
      const double factor = row[i];
      for (std::int64_t j = i; j < size; ++j) below[j] -= factor * row[j];
    }
  }
  Tensor c({size, size});
  for (std::int64_t r = 0; r < size; ++r)
    for (std::int64_t k = 0; k <= r; ++k)
      c.data()[r * size + k] = static_cast<float>(u[static_cast<std::size_t>(k * size + r)]);
  return c;
}

}  // namespace mien::facediffuser
