#pragma once
#include "mien/nn/operations.h"
#include "mien/tensor/tensor.h"

namespace mien {

/// A network over PlainWeights is loaded but not run: every parameter has the shape it is stored with. Fast
/// paths pack from it in their own way.
struct PlainWeights : Tensor {
  using Tensor::Tensor;
};

template <>
struct Operations<PlainWeights> {
  using Matrix = PlainWeights;
};

}  // namespace mien
