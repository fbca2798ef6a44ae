#pragma once
#include "mien/tensor/ops.h"

namespace mien::facediffuser {

/// A square C with C C^T = A A^T, A = filter * weights: C xi has the distribution of A z for white xi and z.
/// Lower triangular. A direction that the weights do not reach (to 1e-7 of the mean) gets no noise.
/// @param weights  [Y, D], D > Y;  taps  of the filter along Y   @return [Y, Y]
Tensor gaussian_factor(const PackedMatrix& weights, const Tensor& taps, int num_threads);

}  // namespace mien::facediffuser
