#include <algorithm>
#include <cmath>

#include "mien/base/contract.h"
#include "mien/tensor/ops.h"
#include "require.h"

namespace mien {
namespace {

/// Product of all axes but the last two.
std::int64_t num_matrices(const Tensor& x) {
  std::int64_t count = 1;
  for (std::size_t i = 0; i + 2 < x.shape().size(); ++i) count *= x.shape()[i];
  return count;
}

bool equal_but(const Shape& a, const Shape& b, std::size_t axis_from_end) {
  if (a.size() != b.size() || a.size() < axis_from_end) return false;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (i != a.size() - axis_from_end && a[i] != b[i]) return false;
  return true;
}

}  // namespace

Tensor concat_last(std::span<const Tensor> parts) {
  contract(!parts.empty() && parts[0].rank() >= 1, "concat_last: nothing to join");
  Shape shape = parts[0].shape();
  shape.back() = 0;
  for (const auto& part : parts) {
    require(equal_but(part.shape(), parts[0].shape(), 1), [&] {
      return "concat_last: " + shape_text(part.shape()) + " does not fit beside " +
             shape_text(parts[0].shape());
    });
    shape.back() += part.width();
  }
  Tensor y = Tensor::uninitialized(std::move(shape));
  float* out = y.data();
  for (std::int64_t r = 0; r < y.num_rows(); ++r)
    for (const auto& part : parts) out = std::copy_n(part.data() + r * part.width(), part.width(), out);
  return y;
}

Tensor concat_rows(const Tensor& a, const Tensor& b) {
  require(a.rank() >= 2 && equal_but(a.shape(), b.shape(), 2), [&] {
    return "concat_rows: " + shape_text(b.shape()) + " does not fit below " + shape_text(a.shape());
  });
  Shape shape = a.shape();
  shape[shape.size() - 2] += b.size(-2);
  Tensor y = Tensor::uninitialized(std::move(shape));
  const std::int64_t size_a = a.size(-2) * a.width(), size_b = b.size(-2) * b.width();
  float* out = y.data();
  for (std::int64_t i = 0; i < num_matrices(a); ++i) {
    out = std::copy_n(a.data() + i * size_a, size_a, out);
    out = std::copy_n(b.data() + i * size_b, size_b, out);
  }
  return y;
}

Tensor rows(const Tensor& x, std::int64_t start, std::int64_t count) {
  require(x.rank() >= 2 && start >= 0 && count >= 0 && start <= x.size(-2) - count, [&] {
    return "rows: " + std::to_string(count) + " rows from " + std::to_string(start) + " are not in " +
           shape_text(x.shape());
  });
  Shape shape = x.shape();
  shape[shape.size() - 2] = count;
  Tensor y = Tensor::uninitialized(std::move(shape));
  const std::int64_t width = x.width();
  float* out = y.data();
  for (std::int64_t i = 0; i < num_matrices(x); ++i)
    out = std::copy_n(x.data() + (i * x.size(-2) + start) * width, count * width, out);
  return y;
}

Tensor columns(const Tensor& x, std::int64_t start, std::int64_t count) {
  require(x.rank() >= 1 && start >= 0 && count >= 0 && start <= x.width() - count, [&] {
    return "columns: " + std::to_string(count) + " columns from " + std::to_string(start) + " are not in " +
           shape_text(x.shape());
  });
  Shape shape = x.shape();
  shape.back() = count;
  Tensor y = Tensor::uninitialized(std::move(shape));
  float* out = y.data();
  for (std::int64_t r = 0; r < x.num_rows(); ++r)
    out = std::copy_n(x.data() + r * x.width() + start, count, out);
  return y;
}

Tensor embedding_rows(const Tensor& table, std::span<const std::int64_t> indices) {
  require(table.rank() == 2,
          [&] { return "embedding_rows: table must be [V, D], got " + shape_text(table.shape()); });
  Tensor y = Tensor::uninitialized({static_cast<std::int64_t>(indices.size()), table.width()});
  float* out = y.data();
  for (const auto index : indices) {
    require(index >= 0 && index < table.size(0), [&] {
      return "embedding_rows: index " + std::to_string(index) + " is not in " + shape_text(table.shape());
    });
    out = std::copy_n(table.data() + index * table.width(), table.width(), out);
  }
  return y;
}

Tensor interpolate_rows(const Tensor& x, std::span<const double> positions) {
  require(x.rank() == 2 && (x.size(0) > 0 || positions.empty()),
          [&] { return "interpolate_rows: x must be [T, D] with T > 0, got " + shape_text(x.shape()); });
  const std::int64_t width = x.width();
  Tensor y = Tensor::uninitialized({static_cast<std::int64_t>(positions.size()), width});
  float* out = y.data();
  for (const double position : positions) {
    contract(!std::isnan(position), "interpolate_rows: a position is NaN");
    const double inside = std::clamp(position, 0.0, static_cast<double>(x.size(0) - 1));
    const auto before = static_cast<std::int64_t>(inside);
    const std::int64_t after = std::min(before + 1, x.size(0) - 1);
    const auto part = static_cast<float>(inside - static_cast<double>(before));
    const float *a = x.data() + before * width, *b = x.data() + after * width;
    if (part == 0.0f) {  // exactly a row: also when the next one is not finite
      out = std::copy_n(a, width, out);
      continue;
    }
    for (std::int64_t i = 0; i < width; ++i) *out++ = a[i] + part * (b[i] - a[i]);
  }
  return y;
}

}  // namespace mien
