#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "mien/tensor/key_range.h"
#include "mien/tensor/matmul.h"
#include "mien/tensor/tensor.h"

// Operations of networks on tensors. All of them treat each row (the last axis) alone and in one way, so with
// weights packed for Backend::rowwise the bits of a row never depend on which other rows are in the tensor.
// An operation that takes its argument by value works in place: x = gelu(std::move(x)).
// Shapes that do not fit are mistakes of the caller: std::logic_error. NaN passes through everywhere.
namespace mien {

// ---- Products
// ------------------------------------------------------------------------------------------------------

/// x [..., K] times w [N, K] plus bias [N] -> [..., N]. An empty bias tensor means none.
Tensor linear(const Tensor& x, const PackedMatrix& w, const Tensor& bias = {}, int num_threads = 1);

/// Convolution over rows without padding, as one product:
/// y[n] = bias + sum over taps j of w[:, j * D ... j * D + D - 1] x[n * stride + j * dilation].
/// @param x  [N, D];  w  [Out, kernel * D], tap by tap as tap_major() gives it;  bias  [Out] or empty
/// @return   [floor((N - (kernel - 1) * dilation - 1) / stride) + 1, Out], no rows when x has too few. A
/// causal
///           convolution is this one behind (kernel - 1) * dilation rows of past (zeros at the start).
Tensor conv_rows(const Tensor& x, const PackedMatrix& w, const Tensor& bias, std::int64_t kernel,
                 std::int64_t dilation = 1, std::int64_t stride = 1, int num_threads = 1);

/// Convolution weights [Out, In, kernel], the order of PyTorch, to [Out, kernel * In] with taps outermost.
Tensor tap_major(const Tensor& weight);

/// Weights of a convolution whose channels form groups that do not mix, packed group by group.
struct PackedGroups {
  std::int64_t kernel = 0, inputs = 0, outputs = 0;  ///< channels in and out of one group
  std::vector<PackedMatrix> groups;                  ///< each [outputs, kernel * inputs]
};
/// @param weight  [Out, In / groups, kernel], the order of PyTorch. @pre groups divides Out
PackedGroups pack_groups(const Tensor& weight, std::int64_t groups, Backend backend = Backend::rowwise);
/// Grouped convolution over rows, stride 1, with `before` and `after` rows of zeros around x.
/// @param x  [N, groups * inputs];  bias  [groups * outputs] or empty
/// @return   [N + before + after - kernel + 1, groups * outputs], no rows when x has too few
Tensor grouped_conv_rows(const Tensor& x, const PackedGroups& w, const Tensor& bias, std::int64_t before,
                         std::int64_t after, int num_threads = 1);
/// Weight norm with one length per tap: w[o, i, k] = g[k] v[o, i, k] / |v[:, :, k]|, lengths in double.
/// @param v  [Out, In, kernel];  g  [1, 1, kernel]
Tensor weight_norm_taps(const Tensor& v, const Tensor& g);

/// Where the heads of an attention read and write. Head h uses columns h * d ... of q, k, v, with d = columns
/// / heads.
struct AttentionInputs {
  View q;     ///< [N, heads * d], already scaled by 1 / sqrt(d)
  View k, v;  ///< [T, heads * d]
  std::int64_t heads = 1;
  std::int64_t valid = -1;  ///< keys from here on are not seen; -1: all are
  Backend backend =
      Backend::rowwise;  ///< of the two products; with rowwise the bits do not depend on the threads
};
/// out[n] = softmax(q[n] k^T) v for each head, a block of queries at a time: the scores never exist as a
/// whole.
/// @param out  [N, heads * d], rows side by side. @pre T > 0 and valid != 0 unless N == 0
void attention(const AttentionInputs& in, float* out, int num_threads = 1);
/// The same where query n sees the keys ranges[n] only; nothing is computed for the others.
/// @param q  [N, heads * d], already scaled;  k, v  [T, heads * d];  out  [N, heads * d]
/// @pre N ranges, each of at least one key
void attention_within(const View& q, const View& k, const View& v, std::int64_t heads,
                      std::span<const KeyRange> ranges, float* out);

/// x [N, D] -> [N - (kernel - 1) * dilation, kernel * D]: row n holds rows n, n + dilation, ... of x, oldest
/// first.
Tensor unfold_rows(const Tensor& x, std::int64_t kernel, std::int64_t dilation = 1);

/// One step of a GRU (PyTorch's equations and gate order r, z, n) for M independent sequences.
/// @param x  [M, In];  h  [M, H];  w_ih  [3 H, In];  w_hh  [3 H, H];  b_ih, b_hh  [3 H]
/// @return   the next state [M, H]
Tensor gru_step(const Tensor& x, const Tensor& h, const PackedMatrix& w_ih, const PackedMatrix& w_hh,
                const Tensor& b_ih, const Tensor& b_hh, int num_threads = 1);
/// The same with the input already projected: gi = linear(x, w_ih, b_ih) [M, 3 H], for all steps at once.
/// Same bits.
Tensor gru_step_projected(const Tensor& gi, const Tensor& h, const PackedMatrix& w_hh, const Tensor& b_hh,
                          int num_threads = 1);

// ---- Value by value
// ------------------------------------------------------------------------------------------------

Tensor exp(Tensor x);      ///< to 1 ulp; 0 and infinity beyond the range of float
Tensor sigmoid(Tensor x);  ///< absolute error below 1.2e-7
Tensor tanh(Tensor x);     ///< relative error below 2e-7
Tensor silu(Tensor x);     ///< x sigmoid(x), relative error below 2.5e-7
Tensor gelu(Tensor x);     ///< x / 2 (1 + erf(x / sqrt(2))), the exact form; error below 1e-7 (1 + |gelu(x)|)
Tensor relu(Tensor x);
/// x / 2 (1 + tanh(sqrt(2 / pi) (x + 0.044715 x^3))), the approximate form that some networks were trained
/// with
Tensor gelu_tanh(Tensor x);
Tensor mish(Tensor x);  ///< x tanh(ln(1 + e^x)), relative error below 4e-7
Tensor scale(Tensor x, float factor);

/// b has the shape of a, or is one row [D] for all rows of a [..., D].
Tensor add(Tensor a, const Tensor& b);
Tensor sub(Tensor a, const Tensor& b);
Tensor mul(Tensor a, const Tensor& b);

// ---- Row by row
// ----------------------------------------------------------------------------------------------------

/// (x - mean) / sqrt(variance + eps) * gamma + beta over the last axis, biased variance, sums in double.
/// @param gamma, beta  [D]
Tensor layer_norm(Tensor x, const Tensor& gamma, const Tensor& beta, double eps = 1e-5);
/// The same over rows and groups of neighbouring channels: x [N, D] over the N D / groups values of a group.
/// @param gamma, beta  [D]. @pre groups divides D
Tensor group_norm(Tensor x, const Tensor& gamma, const Tensor& beta, std::int64_t groups, double eps = 1e-5);
/// exp(x - max) / sum over the last axis. A row of minus infinities gives NaN.
Tensor softmax_last(Tensor x);

// ---- Moving values
// -------------------------------------------------------------------------------------------------

/// Joins along the last axis: all parts have equal leading axes. @pre at least one part
Tensor concat_last(std::span<const Tensor> parts);
/// Joins along the axis before the last: a [..., N, D], b [..., M, D] -> [..., N + M, D]. @pre rank >= 2
Tensor concat_rows(const Tensor& a, const Tensor& b);
/// x [..., N, D] -> [..., count, D] from row `start` on. @pre rank >= 2
Tensor rows(const Tensor& x, std::int64_t start, std::int64_t count);
/// x [..., D] -> [..., count] from column `start` on. @pre rank >= 1
Tensor columns(const Tensor& x, std::int64_t start, std::int64_t count);

/// x [N, D] -> [D, N]. @pre rank 2
Tensor transposed(const Tensor& x);
/// x [N factor, D] -> [N, factor D]: each row of the result is `factor` rows of x. @pre factor divides the
/// rows
Tensor group_rows(const Tensor& x, std::int64_t factor);

/// Convolution along each row, zeros outside: y[i] = bias + sum over j of taps[j] x[i + j - (taps - 1) / 2].
/// @param taps  [K], K odd;  bias  [1]
Tensor convolve_columns(const Tensor& x, const Tensor& taps, const Tensor& bias);
/// The larger of each two neighbouring values: x [..., 2 D] -> [..., D].
Tensor max_pool_pairs(const Tensor& x);
/// The mean of each two neighbouring values.
Tensor mean_pool_pairs(const Tensor& x);

/// table [V, D] -> [indices.size(), D]. @pre 0 <= index < V
Tensor embedding_rows(const Tensor& table, std::span<const std::int64_t> indices);
/// x [T, D] -> [positions.size(), D]: row p of the result lies at row position p of x, linear between
/// neighbours; the first and last row continue outside. @pre T > 0 or no positions; no position is NaN
Tensor interpolate_rows(const Tensor& x, std::span<const double> positions);

}  // namespace mien
