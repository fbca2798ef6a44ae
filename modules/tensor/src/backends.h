#pragma once
#include <cstdint>
#include <memory>

#include "mien/tensor/packed_matrix.h"

namespace mien {

/// Makers of the kernels, one per backend. `weights` is [num_outputs, num_inputs] row-major, both sizes above
/// 0.
using KernelPtr = std::shared_ptr<const PackedMatrix::Kernel>;
KernelPtr make_rowwise_kernel(const float* weights, std::int64_t num_outputs, std::int64_t num_inputs);
KernelPtr make_rowwise_bf16_kernel(const float* weights, std::int64_t num_outputs, std::int64_t num_inputs);
KernelPtr make_eigen_kernel(const float* weights, std::int64_t num_outputs, std::int64_t num_inputs);
KernelPtr make_onednn_kernel(const float* weights, std::int64_t num_outputs, std::int64_t num_inputs,
                             Backend backend);

/// Whether the processor multiplies bfloat16 (AVX512-BF16). A product's rows are then computed alone, as in
/// rowwise.h: sums in the order of k, two at a time.
bool rowwise_bf16_available();
/// Whether the build found the library, and the processor has what the backend needs.
bool eigen_available();
bool onednn_available(Backend backend);

}  // namespace mien
