#include "attention_head.h"

#include <algorithm>
#include <cstring>
#include <vector>

#include "elementwise_dispatch.h"
#include "rowwise_dispatch.h"

namespace mien {
namespace {

using rowwise::kPanel;

std::int64_t num_panels(std::int64_t outputs) { return (outputs + kPanel - 1) / kPanel; }

/// Rows of x in bfloat16 behind each other, with a zero behind those of odd length.
AlignedFloats pairs_of(const View& x) {
  const auto round = elementwise::best_kernels().round_to_bfloat16;
  const std::int64_t num_pairs = (x.columns + 1) / 2;
  AlignedFloats pairs(x.rows * num_pairs);
  auto* out = reinterpret_cast<std::uint16_t*>(pairs.get());
  for (std::int64_t n = 0; n < x.rows; ++n, out += 2 * num_pairs) {
    round(x.data + n * x.stride, out, x.columns);
    if (x.columns % 2 == 1) out[x.columns] = 0;
  }
  return pairs;
}

/// Each row of x [T, d] is one output: panels [T / 16][d][16].
AlignedFloats panels_of_rows(const View& x) {
  AlignedFloats panels(num_panels(x.rows) * x.columns * kPanel);
  float* out = panels.get();
  for (std::int64_t first = 0; first < x.rows; first += kPanel, out += x.columns * kPanel) {
    const std::int64_t count = std::min(kPanel, x.rows - first);
    if (count < kPanel) std::fill_n(out, x.columns * kPanel, 0.0f);
    for (std::int64_t i = 0; i < count; ++i) {
      const float* row = x.data + (first + i) * x.stride;
      for (std::int64_t k = 0; k < x.columns; ++k) out[k * kPanel + i] = row[k];
    }
  }
  return panels;
}

/// Each column of x [T, d] is one output: panels [d / 16][T][16].
AlignedFloats panels_of_columns(const View& x) {
  AlignedFloats panels(num_panels(x.columns) * x.rows * kPanel);
  float* out = panels.get();
  for (std::int64_t first = 0; first < x.columns; first += kPanel) {
    const std::int64_t count = std::min(kPanel, x.columns - first);
    for (std::int64_t t = 0; t < x.rows; ++t, out += kPanel) {
      std::copy_n(x.data + t * x.stride + first, count, out);
      std::fill_n(out + count, kPanel - count, 0.0f);
    }
  }
  return panels;
}

/// The same with two neighbouring rows of bfloat16 in the place of one of float.
AlignedFloats paired_panels_of_columns(const View& x) {
  const std::int64_t num_pairs = (x.rows + 1) / 2, width = num_panels(x.columns) * kPanel;
  AlignedFloats panels(num_pairs * width);
  auto* out = reinterpret_cast<std::uint16_t*>(panels.get());
  const auto round = elementwise::best_kernels().round_to_bfloat16;
  std::vector<std::uint16_t> rows(static_cast<std::size_t>(2 * width));  // zeros behind the columns
  std::uint16_t *even = rows.data(), *odd = even + width;
  for (std::int64_t p = 0; p < num_pairs; ++p) {
    round(x.data + 2 * p * x.stride, even, x.columns);
    if (2 * p + 1 < x.rows)
      round(x.data + (2 * p + 1) * x.stride, odd, x.columns);
    else
      std::fill_n(odd, width, std::uint16_t{0});
    for (std::int64_t i = 0; i < width; ++i) {
      std::uint16_t* to = out + 2 * ((i / kPanel * num_pairs + p) * kPanel + i % kPanel);
      to[0] = even[i], to[1] = odd[i];
    }
  }
  return panels;
}

}  // namespace

AttentionHead::AttentionHead(const View& keys, const View& values, bool is_bf16)
    : num_keys_(keys.rows), width_(keys.columns), is_bf16_(is_bf16) {
  if (is_bf16) {
    const AlignedFloats pairs = pairs_of(keys);
    const std::int64_t num_pairs = (keys.columns + 1) / 2;
    keys_ = panels_of_rows({pairs.get(), keys.rows, num_pairs, num_pairs});
    values_ = paired_panels_of_columns(values);
  } else {
    keys_ = panels_of_rows(keys);
    values_ = panels_of_columns(values);
  }
}

void AttentionHead::multiply(const View& x, const AlignedFloats& panels, std::int64_t num_columns, float* y,
                             std::int64_t stride) const {
  AlignedFloats pairs;
  rowwise::Block block{.x = x.data,
                       .x_stride = x.stride,
                       .rows = x.rows,
                       .panels = panels.get(),
                       .num_panels = num_panels(num_columns),
                       .num_inputs = x.columns,
                       .y = y,
                       .y_stride = stride,
                       .num_columns = num_columns};
  if (is_bf16_) {
    pairs = pairs_of(x);
    block.x = pairs.get();
    block.x_stride = block.num_inputs = (x.columns + 1) / 2;
  }
  rowwise::multiply_for(best_instruction_set(), is_bf16_)(block);
}

void AttentionHead::scores(const View& q, float* out) const { multiply(q, keys_, num_keys_, out, num_keys_); }

void AttentionHead::mix(const float* weights, std::int64_t num_rows, float* out, std::int64_t stride) const {
  multiply({weights, num_rows, num_keys_, num_keys_}, values_, width_, out, stride);
}

}  // namespace mien
