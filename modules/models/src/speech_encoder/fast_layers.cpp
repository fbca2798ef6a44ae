#include "fast_layers.h"

#include <algorithm>
#include <cmath>

#include "mien/base/parallel.h"
#include "mien/tensor/in_place.h"

namespace mien::speech_encoder {
namespace {

/// Rows of a tile: about 96, in whole register tiles of 6 and evenly filled. A function of the length alone.
std::int64_t tile_rows(std::int64_t num_rows) {
  const std::int64_t tiles = std::max<std::int64_t>(1, (num_rows + 95) / 96);
  return ((num_rows + tiles - 1) / tiles + 5) / 6 * 6;
}

template <class Body>
void for_each_tile(std::int64_t num_rows, int num_threads, Body&& body) {
  if (num_rows == 0) return;
  const std::int64_t size = tile_rows(num_rows);
  parallel_for(num_threads, (num_rows + size - 1) / size,
               [&](std::int64_t i) { body(i * size, std::min(size, num_rows - i * size)); });
}

std::span<float> rows_of(Tensor& x, std::int64_t first, std::int64_t count) {
  return {x.data() + first * x.width(), static_cast<std::size_t>(count * x.width())};
}

View view_of(std::span<const float> rows, std::int64_t width) {
  return {rows.data(), static_cast<std::int64_t>(rows.size()) / width, width, width};
}

}  // namespace

FastLayers::FastLayers(SpeechEncoder<PlainWeights>& encoder, Backend front, Backend layers)
    : config_(encoder.config) {
  const auto packed = [](Linear<PlainWeights>& from, Backend backend) {
    Product p{PackedMatrix(from.weight, backend), std::move(from.bias)};
    from.weight = {};
    return p;
  };
  const auto norm = [](LayerNorm<PlainWeights>& from) {
    return Norm{std::move(from.gamma), std::move(from.beta)};
  };
  projection_norm_ = norm(encoder.projection_norm);
  norm_ = norm(encoder.layer_norm);
  projection_ = packed(encoder.projection, front);
  auto& positions = encoder.pos_conv_embed;
  positions_ = pack_groups(weight_norm_taps(positions.weight_v, positions.weight_g), positions.groups);
  positions_bias_ = std::move(positions.bias);
  positions.weight_v = {};

  const std::int64_t width = config_.hidden_size;
  const double scale = 1.0 / std::sqrt(static_cast<double>(width / config_.num_attention_heads));
  for (auto& from : encoder.layers) {
    auto& a = from.attention;
    for (Tensor* queries : {static_cast<Tensor*>(&a.q_proj.weight), static_cast<Tensor*>(&a.q_proj.bias)})
      for (float& v : queries->values()) v *= static_cast<float>(scale);
    Tensor weight = Tensor::uninitialized({3 * width, width}), bias = Tensor::uninitialized({3 * width});
    std::int64_t part = 0;
    for (auto* projection : {&a.q_proj, &a.k_proj, &a.v_proj}) {
      std::ranges::copy(projection->weight.values(), weight.data() + part * width * width);
      std::ranges::copy(projection->bias.values(), bias.data() + part * width);
      projection->weight = {};
      ++part;
    }
    layers_.push_back({.query_key_value = {PackedMatrix(weight, layers), std::move(bias)},
                       .out = packed(a.out_proj, layers),
                       .expand = packed(from.intermediate_dense, layers),
                       .contract = packed(from.output_dense, layers),
                       .attention_norm = norm(from.layer_norm),
                       .final_norm = norm(from.final_layer_norm)});
  }
}

Tensor FastLayers::projected(Tensor x, int num_threads) const {
  Tensor h = Tensor::uninitialized({x.num_rows(), config_.hidden_size});
  for_each_tile(x.num_rows(), num_threads, [&](std::int64_t first, std::int64_t count) {
    const auto tile = rows_of(x, first, count);
    if (config_.feat_proj_layer_norm)
      layer_norm_in_place(tile, {}, projection_norm_.gamma, projection_norm_.beta, config_.layer_norm_eps);
    matmul(view_of(tile, x.width()), projection_.weight, projection_.bias.data(),
           h.data() + first * h.width());
  });
  return h;
}

void FastLayers::query_key_value(const Layer& layer, std::span<const float> h, float* out) const {
  const auto& [weight, bias] = layer.query_key_value;
  if (!config_.do_stable_layer_norm) return matmul(view_of(h, config_.hidden_size), weight, bias.data(), out);
  std::vector<float> normed(h.begin(), h.end());
  layer_norm_in_place(normed, {}, layer.attention_norm.gamma, layer.attention_norm.beta,
                      config_.layer_norm_eps);
  matmul(view_of(normed, config_.hidden_size), weight, bias.data(), out);
}

void FastLayers::finish_layer(const Layer& layer, std::span<float> h, const View& mixed) const {
  const std::int64_t width = config_.hidden_size, count = mixed.rows;
  const double eps = config_.layer_norm_eps;
  const auto& [attention_gamma, attention_beta] = layer.attention_norm;
  const auto& [final_gamma, final_beta] = layer.final_norm;
  Tensor change = Tensor::uninitialized({count, width});
  Tensor inner = Tensor::uninitialized({count, config_.intermediate_size});
  const auto feed_forward = [&](std::span<const float> x) {
    matmul(view_of(x, width), layer.expand.weight, layer.expand.bias.data(), inner.data());
    gelu_in_place(inner.values());
    matmul(inner.view(), layer.contract.weight, layer.contract.bias.data(), change.data());
  };
  matmul(mixed, layer.out.weight, layer.out.bias.data(), change.data());
  if (config_.do_stable_layer_norm) {
    add_in_place(h, change.values());
    std::vector<float> normed(h.begin(), h.end());
    layer_norm_in_place(normed, {}, final_gamma, final_beta, eps);
    feed_forward(normed);
    add_in_place(h, change.values());
  } else {
    layer_norm_in_place(h, change.values(), attention_gamma, attention_beta, eps);
    feed_forward(h);
    layer_norm_in_place(h, change.values(), final_gamma, final_beta, eps);
  }
}

Tensor FastLayers::run(Tensor x, int num_threads,
                       const std::function<void(std::int64_t, const Tensor&)>& on_hidden) const {
  const std::int64_t width = config_.hidden_size, num_rows = x.num_rows();
  Tensor h = projected(std::move(x), num_threads);
  const std::int64_t before = positions_.kernel / 2;
  Tensor position =
      grouped_conv_rows(h, positions_, positions_bias_, before, positions_.kernel - 1 - before, num_threads);
  Tensor queries = Tensor::uninitialized({num_rows, 3 * width});
  for_each_tile(num_rows, num_threads, [&](std::int64_t first, std::int64_t count) {
    const auto tile = rows_of(h, first, count), added = rows_of(position, first, count);
    gelu_in_place(added);
    if (config_.do_stable_layer_norm)
      add_in_place(tile, added);
    else
      layer_norm_in_place(tile, added, norm_.gamma, norm_.beta, config_.layer_norm_eps);
    query_key_value(layers_[0], tile, queries.data() + first * 3 * width);
  });
  if (on_hidden) on_hidden(0, h);
  Tensor& mixed = position;
  for (std::size_t i = 0; i < layers_.size(); ++i) {
    const auto part = [&](std::int64_t p) {
      return View{queries.data() + p * width, num_rows, width, 3 * width};
    };
    attention({part(0), part(1), part(2), config_.num_attention_heads}, mixed.data(), num_threads);
    for_each_tile(num_rows, num_threads, [&](std::int64_t first, std::int64_t count) {
      const auto tile = rows_of(h, first, count);
      finish_layer(layers_[i], tile, view_of(rows_of(mixed, first, count), width));
      if (i + 1 < layers_.size()) query_key_value(layers_[i + 1], tile, queries.data() + first * 3 * width);
    });
    if (on_hidden && i + 1 < layers_.size()) on_hidden(static_cast<std::int64_t>(i + 1), h);
  }
  if (config_.do_stable_layer_norm)
    layer_norm_in_place(h.values(), {}, norm_.gamma, norm_.beta, config_.layer_norm_eps);
  if (on_hidden) on_hidden(static_cast<std::int64_t>(layers_.size()), h);
  return h;
}

}  // namespace mien::speech_encoder
