#pragma once
// Included once by each rowwise_<instruction set>.cpp, after it has defined, in an unnamed namespace,
//   struct Lanes: the 16 columns of a panel, with zero(), load(p) aligned, load_unaligned(p), broadcast(p),
//   store(p),
//                 add_product(a, b): this = fma(a, b, this), lane by lane
//   kMaxPanels[R]: how many panels a tile of R rows spans, so that accumulators stay in registers
// Everything here has internal linkage and calls nothing from the standard library: code compiled for one
// instruction set must never be what the linker keeps for all of them.
#include "rowwise.h"

namespace mien::rowwise {
namespace {

/// R rows times P panels: R * P accumulators.
template <int R, int P>
void tile(const Block& b, const float* x, const float* panels, const float* bias, float* y,
          std::int64_t num_columns) {
  const std::int64_t panel_size = b.num_inputs * kPanel;
  const std::int64_t last = num_columns - (P - 1) * kPanel;  // columns of the last panel
  alignas(64) float edge[kPanel];
  Lanes sum[R][P];
  for (int p = 0; p < P; ++p) {
    Lanes start = Lanes::zero();
    if (bias != nullptr) {
      if (p == P - 1 && last < kPanel) {
        for (std::int64_t i = 0; i < kPanel; ++i) edge[i] = i < last ? bias[p * kPanel + i] : 0.0f;
        start = Lanes::load(edge);
      } else {
        start = Lanes::load_unaligned(bias + p * kPanel);
      }
    }
    for (int r = 0; r < R; ++r) sum[r][p] = start;
  }
  for (std::int64_t k = 0; k < b.num_inputs; ++k) {
    Lanes w[P];
    for (int p = 0; p < P; ++p) w[p] = Lanes::load(panels + p * panel_size + k * kPanel);
    for (int r = 0; r < R; ++r) {
      const Lanes value = Lanes::broadcast(x + r * b.x_stride + k);
      for (int p = 0; p < P; ++p) sum[r][p].add_product(value, w[p]);
    }
  }
  for (int r = 0; r < R; ++r) {
    for (int p = 0; p < P; ++p) {
      float* to = y + r * b.y_stride + p * kPanel;
      if (p == P - 1 && last < kPanel) {
        sum[r][p].store(edge);
        for (std::int64_t i = 0; i < last; ++i) to[i] = edge[i];
      } else {
        sum[r][p].store(to);
      }
    }
  }
}

/// Panel groups of a block of R rows: as wide as registers allow, the rest narrower.
template <int R, int P>
void tile_of_width(int width, const Block& b, const float* x, const float* panels, const float* bias,
                   float* y, std::int64_t num_columns) {
  if constexpr (P > 1) {
    if (width < P) return tile_of_width<R, P - 1>(width, b, x, panels, bias, y, num_columns);
  }
  tile<R, P>(b, x, panels, bias, y, num_columns);
}

template <int R>
void rows_times_panels(const Block& b, std::int64_t first_row, std::int64_t first_panel, int width) {
  const std::int64_t column = first_panel * kPanel;
  const std::int64_t rest = b.num_columns - column;
  tile_of_width<R, kMaxPanels[R]>(width, b, b.x + first_row * b.x_stride, b.panels + column * b.num_inputs,
                                  b.bias == nullptr ? nullptr : b.bias + column,
                                  b.y + first_row * b.y_stride + column,
                                  rest < width * kPanel ? rest : width * kPanel);
}

template <int R>
void all_panels(const Block& b, std::int64_t first_row) {
  for (std::int64_t panel = 0; panel < b.num_panels; panel += kMaxPanels[R]) {
    const std::int64_t rest = b.num_panels - panel;
    rows_times_panels<R>(b, first_row, panel, static_cast<int>(rest < kMaxPanels[R] ? rest : kMaxPanels[R]));
  }
}

/// Whole tiles of kRows rows go panel group by panel group, so that a group's weights stay in the cache for
/// all rows.
void multiply(const Block& b) {
  constexpr int kRows = 6;
  const std::int64_t whole = b.rows / kRows * kRows;
  if (whole > 0) {
    for (std::int64_t panel = 0; panel < b.num_panels; panel += kMaxPanels[kRows]) {
      const std::int64_t rest = b.num_panels - panel;
      const int width = static_cast<int>(rest < kMaxPanels[kRows] ? rest : kMaxPanels[kRows]);
      for (std::int64_t row = 0; row < whole; row += kRows) rows_times_panels<kRows>(b, row, panel, width);
    }
  }
  switch (b.rows - whole) {
    case 1:
      return all_panels<1>(b, whole);
    case 2:
      return all_panels<2>(b, whole);
    case 3:
      return all_panels<3>(b, whole);
    case 4:
      return all_panels<4>(b, whole);
    case 5:
      return all_panels<5>(b, whole);
    default:
      return;
  }
}

}  // namespace
}  // namespace mien::rowwise
