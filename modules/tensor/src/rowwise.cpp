#include <algorithm>

#include "backends.h"
#include "mien/base/parallel.h"
#include "mien/tensor/matmul.h"
#include "rowwise_dispatch.h"

namespace mien {
namespace rowwise {

Multiply multiply_for(InstructionSet set, [[maybe_unused]] bool is_bf16) {
#ifdef MIEN_X86_KERNELS
  if (is_bf16) return multiply_avx512bf16;
  if (set == InstructionSet::avx512) return multiply_avx512;
  if (set == InstructionSet::avx2) return multiply_avx2;
#endif
  (void)set;
  return multiply_generic;
}

AlignedFloats pack_panels(const float* weights, std::int64_t num_outputs, std::int64_t num_inputs) {
  const std::int64_t num_panels = (num_outputs + kPanel - 1) / kPanel;
  AlignedFloats panels(num_panels * num_inputs * kPanel);
  float* out = panels.get();
  for (std::int64_t p = 0; p < num_panels; ++p) {
    for (std::int64_t k = 0; k < num_inputs; ++k) {
      for (std::int64_t i = 0; i < kPanel; ++i) {
        const std::int64_t n = p * kPanel + i;
        *out++ = n < num_outputs ? weights[n * num_inputs + k] : 0.0f;
      }
    }
  }
  return panels;
}

}  // namespace rowwise

namespace {

using rowwise::Block;
using rowwise::kPanel;

// Below this many multiply-adds, starting threads costs more than it saves.
constexpr std::int64_t kWorthAThread = 4'000'000;

class RowwiseKernel final : public PackedMatrix::Kernel {
 public:
  RowwiseKernel(const float* weights, std::int64_t num_outputs, std::int64_t num_inputs)
      : num_outputs_(num_outputs),
        num_inputs_(num_inputs),
        panels_(rowwise::pack_panels(weights, num_outputs, num_inputs)),
        multiply_(rowwise::multiply_for(best_instruction_set())) {}

  void run(const View& x, const float* bias, float* y, int num_threads) const override {
    const std::int64_t num_panels = (num_outputs_ + kPanel - 1) / kPanel;
    const std::int64_t parts = std::clamp<std::int64_t>(x.rows * num_outputs_ * num_inputs_ / kWorthAThread,
                                                        1, std::max(num_threads, 1));
    if (parts == 1) return multiply_(block(x, bias, y, 0, x.rows, 0, num_panels));
    // Many rows: a share of rows for each thread, in whole tiles of 6. Few rows: a share of the columns.
    if (x.rows >= 12 * parts) {
      const std::int64_t share = ((x.rows + parts - 1) / parts + 5) / 6 * 6;
      parallel_for(num_threads, (x.rows + share - 1) / share, [&](std::int64_t i) {
        multiply_(block(x, bias, y, i * share, std::min(share, x.rows - i * share), 0, num_panels));
      });
    } else {
      const std::int64_t share = (num_panels + parts - 1) / parts;
      parallel_for(num_threads, (num_panels + share - 1) / share, [&](std::int64_t i) {
        multiply_(block(x, bias, y, 0, x.rows, i * share, std::min(share, num_panels - i * share)));
      });
    }
  }

  void unpack(std::int64_t first, std::int64_t count, float* out) const override {
    for (std::int64_t n = 0; n < num_outputs_; ++n) {
      const float* column = panels_.get() + n / kPanel * kPanel * num_inputs_ + n % kPanel;
      for (std::int64_t k = first; k < first + count; ++k) *out++ = column[k * kPanel];
    }
  }

 private:
  [[nodiscard]] Block block(const View& x, const float* bias, float* y, std::int64_t first_row,
                            std::int64_t rows, std::int64_t first_panel, std::int64_t num_panels) const {
    const std::int64_t column = first_panel * kPanel;
    return {.x = x.data + first_row * x.stride,
            .x_stride = x.stride,
            .rows = rows,
            .panels = panels_.get() + column * num_inputs_,
            .num_panels = num_panels,
            .num_inputs = num_inputs_,
            .bias = bias == nullptr ? nullptr : bias + column,
            .y = y + first_row * num_outputs_ + column,
            .y_stride = num_outputs_,
            .num_columns = std::min(num_panels * kPanel, num_outputs_ - column)};
  }

  std::int64_t num_outputs_, num_inputs_;
  AlignedFloats panels_;
  rowwise::Multiply multiply_;
};

}  // namespace

KernelPtr make_rowwise_kernel(const float* weights, std::int64_t num_outputs, std::int64_t num_inputs) {
  return std::make_shared<RowwiseKernel>(weights, num_outputs, num_inputs);
}

std::string_view rowwise_instruction_set() { return instruction_set_name(best_instruction_set()); }

}  // namespace mien
