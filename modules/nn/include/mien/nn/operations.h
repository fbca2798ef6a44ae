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
///   conv(x, matrix, bias, kernel, stride)
///                                      along time, no padding; visitor.convolution() names the matrix
///   grouped_conv(x, weight, bias, groups, before, after)
///                                      along time behind and before rows of zeros; weight [out, in /
///                                      groups, kernel] is a tensor
///   weight_norm(v, g)                  g[k] v[o, i, k] / |v[:, :, k]|
///   layer_norm(x, gamma, beta, eps)    over the last axis, population variance; eps 1e-5 unless given
///   group_norm(x, gamma, beta, groups, eps)
///                                      groups of neighbouring channels over all their rows; as many groups
///                                      as channels norm each channel over time
///   attention(q, k, v, heads, valid)   softmax(q k^T) v by heads, q already scaled; keys from
///                                      valid[batch] on are not seen (empty: all are)
///   attention_within(q, k, v, heads, ranges)
///                                      the same where query n sees the keys ranges[n] (KeyRange) alone
///   gelu(x) silu(x) sigmoid(x) tanh(x) elementwise; gelu in its exact (erf) form
///   relu(x) mish(x)                    elementwise
///   gelu_tanh(x) exp(x)                elementwise; GELU in its tanh form
///   gru(x, state, w_ih, w_hh, b_ih, b_hh)  a GRU layer over time, gates r, z, n: x [.., N, in], state [..,
///   1,
///                                      hidden] (updated) -> [.., N, hidden]
///   convolve_columns(x, taps, bias)    along the channel axis, zeros outside; taps [1, 1, odd], bias [1]
///   max_pool_pairs(x) mean_pool_pairs(x)  of neighbouring channels: [.., N, 2 D] -> [.., N, D]
///   group_rows(x, factor)              [.., N factor, D] -> [.., N, factor D]
///   interpolate_rows(x, positions)     linear in time between neighbouring rows -> [.., positions, D]
///   one_hot(x, index, width)           a row [.., 1, width] for the batch of x: one at index, else zero
///   table_row(table, index)            row of a buffer [entries, 1, width] -> [1, width]
///   given_rows(x, values, width)       numbers as rows [.., 1, width]: one row, or one for each batch of x
///   table_rows(table, indices)         rows of a table [entries, W] -> [1, indices, W]
///   constant_rows(x, values, width)    numbers [N, width] as a tensor like x, without batches
///   values(x)                          all numbers of x, row by row
///   add(x, y) mul(x, y)                elementwise; y may be one row [1, D] for every row of x
///   sub(x, y)                          elementwise
///   add_one(x) scale(x, s)             x + 1, s x
///   num_rows(x)                        N
///   rows(x, first, count)              part of the time axis
///   columns(x, first, count)           part of the channel axis
///   concat_rows({x, y, ...})           one after the other in time
///   concat_columns({x, y, ...})        side by side
///   zero_rows(x, count, width)         zeros [.., count, width] with the batch axes of x
///   zero_after(x, valid)               rows from valid[batch] on become 0; valid empty: x
///   replace_rows(x, flags, row)        rows whose flag is not 0 become `row` [D]; flags of all batches in
///                                      a row
///   unfold(x, kernel, dilation)        [.., N, D] -> [.., N - (kernel-1) dilation, kernel D], oldest tap
///                                      first
/// bias may be an empty (runtime) or undefined (training) tensor where a layer has none.
template <class T>
struct Operations;

}  // namespace mien
