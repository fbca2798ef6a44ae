#pragma once
#include <torch/torch.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "mien/nn/operations.h"
#include "mien/tensor/key_range.h"

namespace mien {

/// LibTorch: autograd, CPU or CUDA. Tensors are [batch, rows, channels].
template <>
struct Operations<torch::Tensor> {
  using T = torch::Tensor;
  using Matrix = torch::Tensor;

  static T linear(const T& x, const Matrix& w, const T& b) {
    return b.defined() ? torch::linear(x, w, b) : torch::linear(x, w);
  }
  static T conv(const T& x, const Matrix& w, const T& b, std::int64_t /*kernel*/, std::int64_t stride) {
    return torch::conv1d(x.transpose(-1, -2), w, b, stride).transpose(-1, -2);
  }
  static T grouped_conv(const T& x, const T& weight, const T& b, std::int64_t groups, std::int64_t before,
                        std::int64_t after) {
    const T padded = torch::constant_pad_nd(x.transpose(-1, -2), {before, after});
    const std::int64_t stride = 1, padding = 0,
                       dilation = 1;  // variables: a literal 0 is also a text to the compiler
    return torch::conv1d(padded, weight, b, stride, padding, dilation, groups).transpose(-1, -2);
  }
  static T weight_norm(const T& v, const T& g) {
    return v * (g / v.square().sum(torch::IntArrayRef{0, 1}, /*keepdim=*/true).sqrt());
  }
  static T layer_norm(const T& x, const T& gamma, const T& beta, double eps = 1e-5) {
    return torch::layer_norm(x, {x.size(-1)}, gamma, beta, eps);
  }
  static T group_norm(const T& x, const T& gamma, const T& beta, std::int64_t groups, double eps) {
    return torch::group_norm(x.transpose(-1, -2), groups, gamma, beta, eps).transpose(-1, -2);
  }
  static T attention(const T& q, const T& k, const T& v, std::int64_t heads,
                     std::span<const std::int64_t> valid) {
    return attend(attention_weights(q, k, heads, valid), v);
  }
  static T attention_within(const T& q, const T& k, const T& v, std::int64_t heads,
                            std::span<const KeyRange> ranges) {
    T hidden = torch::ones({q.size(-2), k.size(-2)}, torch::kBool);
    for (std::int64_t n = 0; n < q.size(-2); ++n) {
      const auto [first, end] = ranges[static_cast<std::size_t>(n)];
      hidden.select(0, n).narrow(0, first, end - first).fill_(false);
    }
    const T scores = torch::matmul(by_heads(q, heads), by_heads(k, heads).transpose(-1, -2));
    const float least = -std::numeric_limits<float>::infinity();
    return attend(torch::softmax(scores.masked_fill(hidden.to(q.device()), least), -1), v);
  }
  /// The two halves of attention(), for training, which drops some of the weights [batch, heads, N, T]
  /// between them.
  static T attention_weights(const T& q, const T& k, std::int64_t heads,
                             std::span<const std::int64_t> valid) {
    T scores = torch::matmul(by_heads(q, heads), by_heads(k, heads).transpose(-1, -2));
    for (std::size_t b = 0; b < valid.size(); ++b) {
      const std::int64_t hidden = std::max<std::int64_t>(0, k.size(-2) - valid[b]);
      if (hidden == 0) continue;
      T mask = torch::zeros({k.size(0), 1, 1, k.size(-2)},
                            torch::TensorOptions().dtype(torch::kBool).device(k.device()));
      mask[static_cast<std::int64_t>(b)].narrow(-1, k.size(-2) - hidden, hidden).fill_(true);
      scores = scores.masked_fill(mask, -std::numeric_limits<float>::infinity());
    }
    return torch::softmax(scores, -1);
  }
  static T attend(const T& weights, const T& v) {
    const T mixed = torch::matmul(weights, by_heads(v, weights.size(1))).transpose(1, 2);
    return mixed.reshape({v.size(0), weights.size(2), v.size(-1)});
  }
  static T gelu(const T& x) { return torch::gelu(x); }
  static T silu(const T& x) { return torch::silu(x); }
  static T sigmoid(const T& x) { return torch::sigmoid(x); }
  static T tanh(const T& x) { return torch::tanh(x); }
  static T relu(const T& x) { return torch::relu(x); }
  static T mish(const T& x) { return torch::mish(x); }
  static T gelu_tanh(const T& x) { return torch::gelu(x, "tanh"); }
  static T exp(const T& x) { return torch::exp(x); }
  static T gru(const T& x, T& state, const Matrix& w_ih, const Matrix& w_hh, const T& b_ih, const T& b_hh) {
    // LibTorch wants [layers, batch, hidden] for the state.
    auto [y, last] = torch::gru(x, state.transpose(0, 1).contiguous(), {w_ih, w_hh, b_ih, b_hh},
                                /*has_biases=*/true, /*num_layers=*/1, /*dropout=*/0.0, /*train=*/false,
                                /*bidirectional=*/false, /*batch_first=*/true);
    state = last.transpose(0, 1);
    return y;
  }
  static T convolve_columns(const T& x, const T& taps, const T& bias) {
    const T flat = x.reshape({-1, 1, x.size(-1)});
    return torch::conv1d(flat, taps, bias, /*stride=*/1, /*padding=*/taps.size(-1) / 2).reshape(x.sizes());
  }
  static T max_pool_pairs(const T& x) {
    auto shape = x.sizes().vec();
    shape.back() /= 2;
    return torch::max_pool1d(x.reshape({-1, 1, x.size(-1)}), 2).reshape(shape);
  }
  static T mean_pool_pairs(const T& x) {
    auto shape = x.sizes().vec();
    shape.back() /= 2;
    shape.push_back(2);
    return x.reshape(shape).mean(-1);
  }
  static T group_rows(const T& x, std::int64_t factor) {
    auto shape = x.sizes().vec();
    shape[shape.size() - 2] /= factor;
    shape.back() *= factor;
    return x.reshape(shape);
  }
  static T interpolate_rows(const T& x, std::span<const double> positions) {
    const auto count = static_cast<std::int64_t>(positions.size()), last = x.size(-2) - 1;
    const T before = torch::empty({count}, torch::kLong), part = torch::empty({count, 1}, torch::kDouble);
    for (std::int64_t i = 0; i < count; ++i) {
      const double inside =
          std::clamp(positions[static_cast<std::size_t>(i)], 0.0, static_cast<double>(last));
      before.data_ptr<std::int64_t>()[i] = static_cast<std::int64_t>(inside);
      part.data_ptr<double>()[i] = inside - std::floor(inside);
    }
    const T from = x.index_select(-2, before.to(x.device()));
    const T to = x.index_select(-2, torch::clamp(before + 1, 0, last).to(x.device()));
    return from + part.to(x.options()) * (to - from);
  }
  static T one_hot(const T& x, std::int64_t index, std::int64_t width) {
    T row = zero_rows(x, 1, width);
    row.select(-1, index).fill_(1);
    return row;
  }
  static T table_row(const T& table, std::int64_t index) {
    return table.reshape({-1, table.size(-1)}).narrow(0, index, 1);
  }
  static T given_rows(const T& x, std::span<const float> values, std::int64_t width) {
    return torch::tensor(std::vector<float>(values.begin(), values.end()))
        .to(x.options().requires_grad(false))
        .reshape({-1, 1, width});
  }
  static T table_rows(const T& table, std::span<const std::int64_t> indices) {
    const T index = torch::tensor(std::vector<std::int64_t>(indices.begin(), indices.end()), torch::kLong);
    return table.index_select(0, index.to(table.device())).unsqueeze(0);
  }
  static T constant_rows(const T& x, std::span<const float> values, std::int64_t width) {
    const T rows = torch::tensor(std::vector<float>(values.begin(), values.end())).reshape({-1, width});
    return rows.to(x.options().requires_grad(false));
  }
  static std::vector<float> values(const T& x) {
    const T flat = x.detach().to(torch::kCPU, torch::kFloat).contiguous();
    return {flat.data_ptr<float>(), flat.data_ptr<float>() + flat.numel()};
  }
  static T sub(const T& x, const T& y) { return x - y; }
  static T add(const T& x, const T& y) { return x + y; }
  static T mul(const T& x, const T& y) { return x * y; }
  static T add_one(const T& x) { return x + 1; }
  static T scale(const T& x, float s) { return x * s; }
  static std::int64_t num_rows(const T& x) { return x.size(-2); }
  static T rows(const T& x, std::int64_t first, std::int64_t count) { return x.narrow(-2, first, count); }
  static T columns(const T& x, std::int64_t first, std::int64_t count) { return x.narrow(-1, first, count); }
  static T concat_rows(const std::vector<T>& parts) { return torch::cat(parts, -2); }
  static T concat_columns(const std::vector<T>& parts) { return torch::cat(parts, -1); }
  static T zero_rows(const T& x, std::int64_t count, std::int64_t width) {
    auto shape = x.sizes().vec();
    shape[shape.size() - 2] = count;
    shape[shape.size() - 1] = width;
    return torch::zeros(shape, x.options().requires_grad(false));
  }
  static T zero_after(const T& x, std::span<const std::int64_t> valid) {
    return valid.empty() ? x : x.masked_fill(after(x, valid), 0.0);
  }
  static T replace_rows(const T& x, std::span<const std::uint8_t> flags, const T& row) {
    T mask = torch::empty({x.size(0), x.size(1), 1}, torch::kBool);
    std::transform(flags.begin(), flags.end(), mask.data_ptr<bool>(), [](std::uint8_t f) { return f != 0; });
    return torch::where(mask.to(x.device()), row, x);
  }
  static T unfold(const T& x, std::int64_t kernel, std::int64_t dilation) {
    const std::int64_t count = x.size(-2) - (kernel - 1) * dilation;
    std::vector<T> taps;
    for (std::int64_t k = 0; k < kernel; ++k) taps.push_back(x.narrow(-2, k * dilation, count));
    return torch::cat(taps, -1);
  }

 private:
  /// [batch, N, heads * d] -> [batch, heads, N, d]
  static T by_heads(const T& x, std::int64_t heads) {
    return x.reshape({x.size(0), x.size(1), heads, x.size(2) / heads}).transpose(1, 2);
  }
  /// [batch, N, 1]: true from row valid[batch] on.
  static T after(const T& x, std::span<const std::int64_t> valid) {
    const T limits =
        torch::tensor(std::vector<std::int64_t>(valid.begin(), valid.end()), torch::kLong).to(x.device());
    const T index = torch::arange(x.size(1), limits.options());
    return (index.unsqueeze(0) >= limits.unsqueeze(1)).unsqueeze(-1);
  }
};

}  // namespace mien
