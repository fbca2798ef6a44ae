#include "mien/tensor/packed_matrix.h"

#include <string>

#include "backends.h"
#include "mien/base/contract.h"

namespace mien {

std::string_view backend_name(Backend backend) {
  switch (backend) {
    case Backend::rowwise:
      return "rowwise";
    case Backend::onednn:
      return "onednn";
    case Backend::onednn_bf16:
      return "onednn_bf16";
    case Backend::onednn_int8:
      return "onednn_int8";
    case Backend::eigen:
      return "eigen";
  }
  return "?";
}

bool backend_available(Backend backend) {
  if (backend == Backend::rowwise) return true;
  if (backend == Backend::onednn_bf16 && rowwise_bf16_available()) return true;
  return backend == Backend::eigen ? eigen_available() : onednn_available(backend);
}

PackedMatrix::PackedMatrix(std::span<const float> weights, std::int64_t num_outputs, std::int64_t num_inputs,
                           Backend backend)
    : num_outputs_(num_outputs), num_inputs_(num_inputs), backend_(backend) {
  contract(num_outputs >= 0 && num_inputs >= 0 &&
               static_cast<std::int64_t>(weights.size()) == num_outputs * num_inputs,
           "PackedMatrix: weights do not fill [" + std::to_string(num_outputs) + ", " +
               std::to_string(num_inputs) + "]");
  contract(backend_available(backend),
           "PackedMatrix: backend " + std::string(backend_name(backend)) + " is not available here");
  if (weights.empty()) return;
  switch (backend) {
    case Backend::rowwise:
      kernel_ = make_rowwise_kernel(weights.data(), num_outputs, num_inputs);
      break;
    case Backend::eigen:
      kernel_ = make_eigen_kernel(weights.data(), num_outputs, num_inputs);
      break;
    case Backend::onednn_bf16:
      kernel_ = rowwise_bf16_available()
                    ? make_rowwise_bf16_kernel(weights.data(), num_outputs, num_inputs)
                    : make_onednn_kernel(weights.data(), num_outputs, num_inputs, backend);
      break;
    default:
      kernel_ = make_onednn_kernel(weights.data(), num_outputs, num_inputs, backend);
      break;
  }
}

PackedMatrix::PackedMatrix(const Tensor& weights, Backend backend)
    : PackedMatrix(weights.values(), weights.num_rows(), weights.width(), backend) {
  contract(weights.rank() == 2, "PackedMatrix: weights must be [N, K], got " + shape_text(weights.shape()));
}

void PackedMatrix::Kernel::unpack(std::int64_t, std::int64_t, float*) const {
  contract(false, "PackedMatrix::unpacked: this backend does not keep the weights as they were given");
}

Tensor PackedMatrix::unpacked(std::int64_t first_input, std::int64_t count) const {
  contract(first_input >= 0 && count >= 0 && first_input <= num_inputs_ - count,
           "PackedMatrix::unpacked: there are no such columns");
  Tensor out = Tensor::uninitialized({num_outputs_, count});
  if (out.count() > 0) kernel_->unpack(first_input, count, out.data());
  return out;
}

}  // namespace mien
