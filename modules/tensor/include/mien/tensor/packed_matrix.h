#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

#include "mien/tensor/tensor.h"

namespace mien {

/// Who computes a product with a packed matrix.
enum class Backend {
  /// Our own kernel, float32. The result of a row has the same bits whatever the other rows, the number of
  /// rows, the
  /// number of threads and the processor are: what streaming needs to equal offline.
  rowwise,
  onednn,       ///< oneDNN, float32
  onednn_bf16,  ///< inputs and weights rounded to bfloat16, float32 sums; own kernel where AVX512-BF16 is
  onednn_int8,  ///< oneDNN, weights in 8 bits with a scale per output, inputs with a scale per row; 32-bit
                ///< exact sums
  eigen,        ///< Eigen, float32: portable
};

std::string_view backend_name(Backend backend);
/// Whether this build and this processor can run it. rowwise always can.
bool backend_available(Backend backend);

/// Weights [N outputs, K inputs] laid out once for a backend. Immutable and shared by threads; copies share
/// the memory.
class PackedMatrix {
 public:
  PackedMatrix() = default;  ///< [0, 0]
  /// @param weights  [N, K] row-major, N * K values. @pre backend_available(backend)
  PackedMatrix(std::span<const float> weights, std::int64_t num_outputs, std::int64_t num_inputs,
               Backend backend = Backend::rowwise);
  /// @param weights  [N, K]
  explicit PackedMatrix(const Tensor& weights, Backend backend = Backend::rowwise);

  [[nodiscard]] std::int64_t num_outputs() const { return num_outputs_; }
  [[nodiscard]] std::int64_t num_inputs() const { return num_inputs_; }
  [[nodiscard]] Backend backend() const { return backend_; }
  /// The weights as they were given, [N, K], or some of their columns. @pre backend() == Backend::rowwise
  [[nodiscard]] Tensor unpacked() const { return unpacked(0, num_inputs_); }
  [[nodiscard]] Tensor unpacked(std::int64_t first_input, std::int64_t count) const;

  /// Weights in the layout of one backend, and the product with them.
  class Kernel {
   public:
    virtual ~Kernel() = default;
    /// See matmul(); sizes are already checked, and rows, inputs and outputs are not 0.
    virtual void run(const View& x, const float* bias, float* y, int num_threads) const = 0;
    /// Columns `first` ... `first` + count - 1 of all outputs, [N, count]. Only kernels that keep the weights
    /// as they were given can.
    virtual void unpack(std::int64_t first, std::int64_t count, float* out) const;
  };
  /// nullptr when N or K is 0.
  [[nodiscard]] const Kernel* kernel() const { return kernel_.get(); }

 private:
  std::int64_t num_outputs_ = 0;
  std::int64_t num_inputs_ = 0;
  Backend backend_ = Backend::rowwise;
  std::shared_ptr<const Kernel> kernel_;
};

}  // namespace mien
