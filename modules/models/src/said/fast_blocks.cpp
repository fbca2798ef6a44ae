#include "fast_blocks.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "mien/tensor/in_place.h"

namespace mien::said {
namespace {

// Rows of a tile of the feed-forward part, whose inner values then stay in the cache.
constexpr std::int64_t kTileRows = 48;
constexpr double kLayerNormEps = 1e-5;

Tensor values_of(const PlainWeights& from) { return from; }

Product packed(const Linear<PlainWeights>& from, Backend backend) {
  return {PackedMatrix(from.weight, backend), values_of(from.bias)};
}

Product packed(const Conv<PlainWeights>& from, Backend backend) {
  return {PackedMatrix(tap_major(from.weight), backend), values_of(from.bias)};
}

PackedGroupNorm packed(const GroupNorm<PlainWeights>& from) { return {from.gamma, from.beta, from.eps}; }

View rows_of(const Tensor& x, std::int64_t first, std::int64_t count) {
  return {x.data() + first * x.width(), count, x.width(), x.width()};
}

// Rows of `above` over those of `below`.
Tensor stacked(std::span<const Tensor* const> parts) {
  std::int64_t num_rows = 0;
  for (const Tensor* part : parts) num_rows += part->num_rows();
  Tensor all = Tensor::uninitialized({num_rows, parts[0]->width()});
  float* to = all.data();
  for (const Tensor* part : parts) to = std::ranges::copy(part->values(), to).out;
  return all;
}

// a b, in double. a [M, K], b [K, N]
Tensor product(const Tensor& a, const Tensor& b) {
  Tensor out({a.num_rows(), b.width()});
  std::vector<double> sums(static_cast<std::size_t>(b.width()));
  for (std::int64_t m = 0; m < a.num_rows(); ++m) {
    std::ranges::fill(sums, 0.0);
    for (std::int64_t k = 0; k < a.width(); ++k) {
      const double factor = a.data()[m * a.width() + k];
      const float* row = b.data() + k * b.width();
      for (std::size_t n = 0; n < sums.size(); ++n) sums[n] += factor * row[n];
    }
    std::ranges::transform(sums, out.data() + m * b.width(), [](double v) { return static_cast<float>(v); });
  }
  return out;
}

Tensor as_matrix(const Tensor& x) { return x.reshaped({x.size(0), x.count() / x.size(0)}); }

}  // namespace

Tensor normed_and_padded(const Tensor& x, const PackedGroupNorm& norm) {
  const std::int64_t width = x.width(), num_rows = x.num_rows();
  Tensor out = Tensor::uninitialized({num_rows + 2, width});
  std::fill_n(out.data(), width, 0.0f);
  std::fill_n(out.data() + (num_rows + 1) * width, width, 0.0f);
  group_norm_rows(x, norm.gamma, norm.beta, {.groups = Sizes::kGroups, .eps = norm.eps, .silu = true},
                  out.data() + width);
  return out;
}

Tensor padded(const Tensor& x) {
  Tensor out({x.num_rows() + 2, x.width()});
  std::ranges::copy(x.values(), out.data() + x.width());
  return out;
}

Tensor convolved(const Tensor& padded_rows, const Product& conv, std::span<const float> bias) {
  const std::int64_t width = padded_rows.width(), count = padded_rows.num_rows() - 2;
  Tensor y = Tensor::uninitialized({count, conv.weight.num_outputs()});
  matmul({padded_rows.data(), count, 3 * width, width}, conv.weight, bias.data(), y.data());
  return y;
}

FastResBlock::FastResBlock(const ResBlock<PlainWeights>& from, const Tensor& embeddings, Backend backend)
    : in_norm(packed(from.in_norm)),
      out_norm(packed(from.out_norm)),
      in_conv(packed(from.in_conv, backend)),
      out_conv(packed(from.out_conv, backend)) {
  if (from.in != from.out) {
    skip = {PackedMatrix(as_matrix(from.skip.weight), backend), values_of(from.skip.bias)};
    add_in_place(out_conv.bias.values(), skip.bias.values());
  }
  step_bias = linear(embeddings, PackedMatrix(from.step.weight), from.step.bias);
  for (std::int64_t t = 0; t < step_bias.num_rows(); ++t)
    add_in_place(step_bias.row(t), in_conv.bias.values());
}

Tensor FastResBlock::run(const Tensor& x, std::int64_t step) const {
  const Tensor h = convolved(normed_and_padded(x, in_norm), in_conv, step_bias.row(step));
  Tensor y = convolved(normed_and_padded(h, out_norm), out_conv, out_conv.bias.values());
  if (skip.weight.num_outputs() == 0) {
    add_in_place(y.values(), x.values());
  } else {
    Tensor straight = Tensor::uninitialized(y.shape());
    matmul(x.view(), skip.weight, nullptr, straight.data());
    add_in_place(y.values(), straight.values());
  }
  return y;
}

FastTransformerBlock::FastTransformerBlock(const TransformerBlock<PlainWeights>& from,
                                           std::span<const float> null_condition, Backend backend)
    : norm(packed(from.norm)),
      norm1_gamma(from.norm1.gamma),
      norm1_beta(from.norm1.beta),
      norm2_gamma(from.norm2.gamma),
      norm2_beta(from.norm2.beta),
      norm3_gamma(from.norm3.gamma),
      norm3_beta(from.norm3.beta),
      self_out(packed(from.attn1.to_out, backend)),
      cross_out(packed(from.attn2.to_out, backend)),
      expand(packed(from.ff.expand, backend)),
      width(from.width),
      inner(from.inner),
      heads(from.width / Sizes::kHeadWidth) {
  const auto factor = static_cast<float>(1.0 / std::sqrt(static_cast<double>(Sizes::kHeadWidth)));
  const Tensor scaled = scale(values_of(from.attn1.to_q.weight), factor);
  const Tensor* self[] = {&scaled, &from.attn1.to_k.weight, &from.attn1.to_v.weight};
  query_key_value = PackedMatrix(stacked(self), backend);
  query = {PackedMatrix(scale(values_of(from.attn2.to_q.weight), factor), backend), {}};
  const Tensor* cross[] = {&from.attn2.to_k.weight, &from.attn2.to_v.weight};
  key_value = PackedMatrix(stacked(cross));

  // Behind the feed-forward part stands a product alone: both become one.
  const Tensor projection = as_matrix(from.proj_out.weight);
  const std::vector<Tensor> sides = {product(projection, from.ff.contract.weight), projection};
  finish.weight = PackedMatrix(concat_last(sides), backend);
  const Tensor bias_column = from.ff.contract.bias.reshaped({width, 1});
  finish.bias = add(product(projection, bias_column).reshaped({width}), from.proj_out.bias);

  // Every frame that attention may look at is the same: whatever the weights, their mean is its value.
  const Tensor condition({1, static_cast<std::int64_t>(null_condition.size())}, null_condition);
  const Tensor value = linear(condition, PackedMatrix(from.attn2.to_v.weight));
  null_cross =
      linear(value, PackedMatrix(from.attn2.to_out.weight), from.attn2.to_out.bias).reshaped({width});
}

Tensor FastTransformerBlock::begin(const Tensor& x) const {
  Tensor y = Tensor::uninitialized(x.shape()), normed = Tensor::uninitialized(x.shape());
  group_norm_rows(x, norm.gamma, norm.beta, {.groups = Sizes::kGroups, .eps = norm.eps}, y.data());
  layer_norm_rows(y.values(), norm1_gamma, norm1_beta, kLayerNormEps, normed.data());
  Tensor projected = Tensor::uninitialized({x.num_rows(), 3 * width});
  matmul(normed.view(), query_key_value, nullptr, projected.data());
  const auto part = [&](std::int64_t p) {
    return View{projected.data() + p * width, x.num_rows(), width, 3 * width};
  };
  attention({part(0), part(1), part(2), heads, -1, query_key_value.backend()}, normed.data());
  Tensor change = Tensor::uninitialized(y.shape());
  matmul(normed.view(), self_out.weight, self_out.bias.data(), change.data());
  add_in_place(y.values(), change.values());
  return y;
}

Tensor FastTransformerBlock::end(const Tensor& x, Tensor y, const Tensor* keys_and_values,
                                 std::span<const KeyRange> ranges) const {
  const std::int64_t num_rows = x.num_rows();
  if (keys_and_values != nullptr) {
    Tensor normed = Tensor::uninitialized(y.shape()), queries = Tensor::uninitialized(y.shape());
    layer_norm_rows(y.values(), norm2_gamma, norm2_beta, kLayerNormEps, normed.data());
    matmul(normed.view(), query.weight, nullptr, queries.data());
    const auto part = [&](std::int64_t p) {
      return View{keys_and_values->data() + p * width, keys_and_values->num_rows(), width, 2 * width};
    };
    attention_within(queries.view(), part(0), part(1), heads, ranges, normed.data());
    matmul(normed.view(), cross_out.weight, cross_out.bias.data(), queries.data());
    add_in_place(y.values(), queries.values());
  } else {
    for (std::int64_t n = 0; n < num_rows; ++n) add_in_place(y.row(n), null_cross.values());
  }
  Tensor out = Tensor::uninitialized(x.shape());
  Tensor normed = Tensor::uninitialized({std::min(kTileRows, num_rows), width});
  Tensor both = Tensor::uninitialized({normed.num_rows(), 2 * inner});
  Tensor joined = Tensor::uninitialized({normed.num_rows(), inner + width});
  for (std::int64_t first = 0; first < num_rows; first += kTileRows) {
    const std::int64_t count = std::min(kTileRows, num_rows - first);
    const auto own = [&](auto& of) {
      return of.values().subspan(static_cast<std::size_t>(first * width),
                                 static_cast<std::size_t>(count * width));
    };
    layer_norm_rows(own(std::as_const(y)), norm3_gamma, norm3_beta, kLayerNormEps, normed.data());
    matmul(rows_of(normed, 0, count), expand.weight, expand.bias.data(), both.data());
    for (std::int64_t n = 0; n < count; ++n) {
      const float* values = both.data() + n * 2 * inner;
      float* to = joined.data() + n * joined.width();
      const auto size = static_cast<std::size_t>(inner);
      gated_gelu({values, size}, {values + inner, size}, to);
      std::copy_n(y.data() + (first + n) * width, width, to + inner);
    }
    matmul(rows_of(joined, 0, count), finish.weight, finish.bias.data(), out.data() + first * width);
    add_in_place(own(out), own(x));
  }
  return out;
}

}  // namespace mien::said
