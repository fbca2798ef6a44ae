#pragma once
#include "mien/tensor/packed_matrix.h"

namespace mien {

/// The one door to matrix arithmetic: y[m, n] = bias[n] + sum over k of x[m, k] * w[n, k].
///
/// @param x     [M, K], rows `stride` apart; 0 rows are fine
/// @param w     [N, K], packed for a backend
/// @param bias  [N], or nullptr for none
/// @param y     [M, N], written; must not overlap x
/// @param num_threads  the work is split over outputs when it is large enough to pay; the rowwise backend
/// gives the
///                     same bits for any number
/// @pre x.columns == w.num_inputs()
void matmul(const View& x, const PackedMatrix& w, const float* bias, float* y, int num_threads = 1);

/// The instruction set that the rowwise kernel uses here: "avx512", "avx2" or "generic". All give the same
/// bits.
std::string_view rowwise_instruction_set();

}  // namespace mien
