#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "mien/nn/operations.h"
#include "mien/tensor/ops.h"

namespace mien {

/// The runtime: tensors are [rows, channels], without batch axes. Every operation treats each row alone, so a
/// network gives the same bits for a row whatever else is in the tensor: what streaming needs to equal
/// offline.
template <>
struct Operations<Tensor> {
  using Matrix = PackedMatrix;

  static Tensor linear(const Tensor& x, const Matrix& w, const Tensor& b) { return mien::linear(x, w, b); }
  static Tensor conv(const Tensor& x, const Matrix& w, const Tensor& b, std::int64_t kernel,
                     std::int64_t stride) {
    return conv_rows(x, w, b, kernel, 1, stride);
  }
  static Tensor grouped_conv(const Tensor& x, const Tensor& weight, const Tensor& b, std::int64_t groups,
                             std::int64_t before, std::int64_t after) {
    return grouped_conv_rows(x, pack_groups(weight, groups), b, before, after);
  }
  static Tensor weight_norm(const Tensor& v, const Tensor& g) { return weight_norm_taps(v, g); }
  static Tensor layer_norm(Tensor x, const Tensor& gamma, const Tensor& beta, double eps = 1e-5) {
    return mien::layer_norm(std::move(x), gamma, beta, eps);
  }
  static Tensor group_norm(Tensor x, const Tensor& gamma, const Tensor& beta, std::int64_t groups,
                           double eps) {
    return mien::group_norm(std::move(x), gamma, beta, groups, eps);
  }
  /// One batch: `valid` has at most one entry.
  static Tensor attention(const Tensor& q, const Tensor& k, const Tensor& v, std::int64_t heads,
                          std::span<const std::int64_t> valid);
  static Tensor attention_within(const Tensor& q, const Tensor& k, const Tensor& v, std::int64_t heads,
                                 std::span<const KeyRange> ranges);
  static Tensor gelu(Tensor x) { return mien::gelu(std::move(x)); }
  static Tensor silu(Tensor x) { return mien::silu(std::move(x)); }
  static Tensor sigmoid(Tensor x) { return mien::sigmoid(std::move(x)); }
  static Tensor tanh(Tensor x) { return mien::tanh(std::move(x)); }
  static Tensor relu(Tensor x) { return mien::relu(std::move(x)); }
  static Tensor mish(Tensor x) { return mien::mish(std::move(x)); }
  static Tensor gelu_tanh(Tensor x) { return mien::gelu_tanh(std::move(x)); }
  static Tensor exp(Tensor x) { return mien::exp(std::move(x)); }
  static Tensor gru(const Tensor& x, Tensor& state, const Matrix& w_ih, const Matrix& w_hh,
                    const Tensor& b_ih, const Tensor& b_hh);
  static Tensor convolve_columns(const Tensor& x, const Tensor& taps, const Tensor& bias) {
    return mien::convolve_columns(x, taps, bias);
  }
  static Tensor max_pool_pairs(const Tensor& x) { return mien::max_pool_pairs(x); }
  static Tensor mean_pool_pairs(const Tensor& x) { return mien::mean_pool_pairs(x); }
  static Tensor group_rows(const Tensor& x, std::int64_t factor) { return mien::group_rows(x, factor); }
  static Tensor interpolate_rows(const Tensor& x, std::span<const double> positions) {
    return mien::interpolate_rows(x, positions);
  }
  static Tensor one_hot(const Tensor& x, std::int64_t index, std::int64_t width);
  static Tensor table_row(const Tensor& table, std::int64_t index);
  static Tensor given_rows(const Tensor& x, std::span<const float> values, std::int64_t width);
  static Tensor table_rows(const Tensor& table, std::span<const std::int64_t> indices) {
    return embedding_rows(table, indices);
  }
  static Tensor constant_rows(const Tensor&, std::span<const float> values, std::int64_t width) {
    return Tensor({static_cast<std::int64_t>(values.size()) / width, width}, values);
  }
  static std::vector<float> values(const Tensor& x) { return {x.values().begin(), x.values().end()}; }
  static Tensor sub(Tensor x, const Tensor& y) { return mien::sub(std::move(x), y); }
  static Tensor add(Tensor x, const Tensor& y);
  static Tensor mul(Tensor x, const Tensor& y);
  static Tensor add_one(Tensor x);
  static Tensor scale(Tensor x, float s) { return mien::scale(std::move(x), s); }
  static std::int64_t num_rows(const Tensor& x) { return x.num_rows(); }
  static Tensor rows(const Tensor& x, std::int64_t first, std::int64_t count) {
    return mien::rows(x, first, count);
  }
  static Tensor columns(const Tensor& x, std::int64_t first, std::int64_t count) {
    return mien::columns(x, first, count);
  }
  static Tensor concat_rows(const std::vector<Tensor>& parts);
  static Tensor concat_columns(const std::vector<Tensor>& parts) { return concat_last(parts); }
  static Tensor zero_rows(const Tensor&, std::int64_t count, std::int64_t width) {
    return Tensor({count, width});
  }
  static Tensor zero_after(Tensor x, std::span<const std::int64_t> valid);
  static Tensor replace_rows(Tensor x, std::span<const std::uint8_t> flags, const Tensor& row);
  static Tensor unfold(const Tensor& x, std::int64_t kernel, std::int64_t dilation) {
    return unfold_rows(x, kernel, dilation);
  }
};

}  // namespace mien
