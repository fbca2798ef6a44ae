#pragma once

namespace mien {

/// What a network needs from a tensor library. Networks are templates over the tensor type T and reach
/// arithmetic only through Operations<T>; there is one specialisation for the runtime (Tensor,
/// runtime_operations.h) and one for training (torch::Tensor, in the train room).
///
/// The last axis holds channels, the one before it time ("rows"); leading axes, if any, are batches. A
/// specialisation offers, with x, y of type T:
///
///   type Matrix                        weights of a linear map, [out, in]
///   linear(x, matrix, bias)            x [.., N, in] -> [.., N, out]
///   layer_norm(x, gamma, beta)         over the last axis, epsilon 1e-5
///   gelu(x) silu(x) sigmoid(x) tanh(x) elementwise; gelu in its exact (erf) form
///   add(x, y) mul(x, y)                elementwise; y may be one row [1, D] for every row of x
///   add_one(x) scale(x, s)             x + 1, s x
///   num_rows(x)                        N
///   rows(x, first, count)              part of the time axis
///   columns(x, first, count)           part of the channel axis
///   concat_rows({x, y, ...})           one after the other in time
///   concat_columns({x, y, ...})        side by side
///   zero_rows(x, count, width)         zeros [.., count, width] with the batch axes of x
///   unfold(x, kernel, dilation)        [.., N, D] -> [.., N - (kernel-1) dilation, kernel D], oldest tap
///   first
template <class T>
struct Operations;

}  // namespace mien
