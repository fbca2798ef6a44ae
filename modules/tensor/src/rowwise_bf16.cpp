#include <algorithm>
#include <cstring>

#include "backends.h"
#include "elementwise_dispatch.h"
#include "mien/base/parallel.h"
#include "mien/tensor/aligned_floats.h"
#include "mien/tensor/matmul.h"
#include "rowwise.h"

namespace mien {

bool rowwise_bf16_available() {
#ifdef MIEN_X86_KERNELS
  return __builtin_cpu_supports("avx512bf16") && best_instruction_set() == InstructionSet::avx512;
#else
  return false;
#endif
}

#ifdef MIEN_X86_KERNELS
namespace {

using rowwise::Block;
using rowwise::kPanel;

// The panels of rowwise.h with a pair of neighbouring inputs in the place of each float.
class Bf16Kernel final : public PackedMatrix::Kernel {
 public:
  Bf16Kernel(const float* weights, std::int64_t num_outputs, std::int64_t num_inputs)
      : num_outputs_(num_outputs), num_inputs_(num_inputs), panels_(num_panels() * num_pairs() * kPanel) {
    std::vector<std::uint16_t> row(static_cast<std::size_t>(2 * num_pairs()));
    std::memset(panels_.get(), 0,
                static_cast<std::size_t>(num_panels() * num_pairs() * kPanel) * sizeof(float));
    for (std::int64_t n = 0; n < num_outputs; ++n) {
      round_(weights + n * num_inputs, row.data(), num_inputs);
      float* column = panels_.get() + n / kPanel * num_pairs() * kPanel + n % kPanel;
      for (std::int64_t k = 0; k < num_pairs(); ++k) std::memcpy(column + k * kPanel, row.data() + 2 * k, 4);
    }
  }

  void run(const View& x, const float* bias, float* y, int num_threads) const override {
    const bool is_run = x.rows > 1 && x.stride < num_inputs_ && x.stride % 2 == 0 && num_inputs_ % 2 == 0;
    const std::int64_t stride = is_run ? x.stride : 2 * num_pairs();
    AlignedFloats pairs(is_run ? ((x.rows - 1) * x.stride + num_inputs_) / 2 : x.rows * num_pairs());
    auto* narrow = reinterpret_cast<std::uint16_t*>(pairs.get());
    if (is_run) {  // rows that overlap, as those of a convolution do, are rounded once
      round_(x.data, narrow, (x.rows - 1) * x.stride + num_inputs_);
    } else {
      for (std::int64_t m = 0; m < x.rows; ++m) {
        round_(x.data + m * x.stride, narrow + m * stride, num_inputs_);
        if (num_inputs_ % 2 == 1) narrow[m * stride + num_inputs_] = 0;
      }
    }
    const auto part = [&](std::int64_t first, std::int64_t count) {
      rowwise::multiply_avx512bf16({.x = pairs.get() + first * stride / 2,
                                    .x_stride = stride / 2,
                                    .rows = count,
                                    .panels = panels_.get(),
                                    .num_panels = num_panels(),
                                    .num_inputs = num_pairs(),
                                    .bias = bias,
                                    .y = y + first * num_outputs_,
                                    .y_stride = num_outputs_,
                                    .num_columns = num_outputs_});
    };
    const std::int64_t parts = std::max(1, num_threads), share = ((x.rows + parts - 1) / parts + 5) / 6 * 6;
    parallel_for(num_threads, (x.rows + share - 1) / share,
                 [&](std::int64_t i) { part(i * share, std::min(share, x.rows - i * share)); });
  }

 private:
  [[nodiscard]] std::int64_t num_panels() const { return (num_outputs_ + kPanel - 1) / kPanel; }
  [[nodiscard]] std::int64_t num_pairs() const { return (num_inputs_ + 1) / 2; }

  decltype(elementwise::Kernels::round_to_bfloat16) round_ = elementwise::best_kernels().round_to_bfloat16;
  std::int64_t num_outputs_, num_inputs_;
  AlignedFloats panels_;
};

}  // namespace
#endif

KernelPtr make_rowwise_bf16_kernel([[maybe_unused]] const float* weights,
                                   [[maybe_unused]] std::int64_t num_outputs,
                                   [[maybe_unused]] std::int64_t num_inputs) {
#ifdef MIEN_X86_KERNELS
  return std::make_shared<Bf16Kernel>(weights, num_outputs, num_inputs);
#else
  return nullptr;
#endif
}

}  // namespace mien
