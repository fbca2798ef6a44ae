#pragma once
#include <string>

#include "mien/tensor/packed_matrix.h"
#include "require.h"

namespace mien {

/// The values of a bias that fits the weights, nullptr for an empty one.
inline const float* checked_bias(const Tensor& bias, const PackedMatrix& w) {
  if (bias.count() == 0) return nullptr;
  require(bias.count() == w.num_outputs(), [&] {
    return "bias " + shape_text(bias.shape()) + " does not fit " + std::to_string(w.num_outputs()) +
           " outputs";
  });
  return bias.data();
}

}  // namespace mien
