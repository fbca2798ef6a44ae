#pragma once
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "mien/models/speech_encoder/encoder_config.h"
#include "mien/models/speech_encoder/speech_statistics.h"
#include "mien/nn/layers.h"

namespace mien {

// The network of HuBERT (Hsu et al. 2021) and wav2vec 2.0 (Baevski et al. 2020). Letters: S samples at 16
// kHz, T frames at 50 Hz, C channels of a convolution, D hidden_size, F intermediate_size. Names are those of
// the Hugging Face checkpoints.

/// The epsilon of the norms between the convolutions; fixed in the original, unlike layer_norm_eps.
inline constexpr double kConvNormEps = 1e-5;

/// Where training drops values at random.
enum class DropoutSite { projection, hidden, activation };

/// What happens between the layers of the encoder: nothing, when it runs. Training passes an object with the
/// same functions that drops values; tests pass one that keeps every stage.
template <class T>
struct EvaluationHooks {
  T dropout(DropoutSite, T x) const { return x; }
  T attention(const T& q, const T& k, const T& v, std::int64_t heads,
              std::span<const std::int64_t> valid) const {
    return Operations<T>::attention(q, k, v, heads, valid);
  }
  /// Called with "conv" 0 ... 6, "interpolated", "projection", "pos_conv", "encoder_layer_norm", "layer" 0
  /// ..., where the index counts stages of one name.
  void stage(const char* /*name*/, std::int64_t /*index*/, const T& /*x*/) const {}
};

/// What one call of the encoder may be given beside the sound. Everything is empty when a clip is encoded
/// alone.
struct EncoderCall {
  /// Linear interpolation of the convolutions' output to this many frames, first on first and last on last
  /// (SAiD).
  std::int64_t num_frames = 0;
  std::span<const std::int64_t> valid_frames;  ///< by batch item: frames from here on are padding
  std::span<const std::uint8_t>
      masked_frames;  ///< SpecAugment [batch * T]: 1 = replaced by masked_spec_embed
  std::span<const std::uint8_t> skipped_layers;  ///< LayerDrop, by layer: 1 = left out
};

/// One block of the feature extractor: convolution, norm where the configuration has one, GELU.
template <class T>
struct EncoderConvLayer {
  enum class Norm { none, group, layer };
  std::int64_t in = 0, out = 0, kernel = 0, stride = 0;
  bool has_bias = false;
  Norm norm = Norm::none;
  typename Operations<T>::Matrix weight{};
  T bias{}, norm_weight{}, norm_bias{};

  template <class V>
  void visit(V& v) {
    v.convolution("conv.weight", weight, out, in, kernel, Init::fan_in);
    if (has_bias) v.tensor("conv.bias", bias, Shape{out}, Init::zero);
    if (norm == Norm::none) return;
    v.tensor("layer_norm.weight", norm_weight, Shape{out}, Init::one);
    v.tensor("layer_norm.bias", norm_bias, Shape{out}, Init::zero);
  }
  /// x [.., N, in] -> [.., floor((N - kernel) / stride) + 1, out]
  T operator()(const T& x) const {
    using B = Operations<T>;
    T y = B::conv(x, weight, bias, kernel, stride);
    if (norm == Norm::group) y = B::group_norm(std::move(y), norm_weight, norm_bias, out, kConvNormEps);
    if (norm == Norm::layer) y = B::layer_norm(std::move(y), norm_weight, norm_bias, kConvNormEps);
    return B::gelu(std::move(y));
  }
};

template <class T>
struct EncoderAttention {
  std::int64_t width = 0, heads = 1;
  Linear<T> k_proj{width, width}, v_proj{width, width}, q_proj{width, width}, out_proj{width, width};

  template <class V>
  void visit(V& v) {
    v.scope("k_proj", k_proj);
    v.scope("v_proj", v_proj);
    v.scope("q_proj", q_proj);
    v.scope("out_proj", out_proj);
  }
  template <class Hooks>
  T operator()(const T& x, std::span<const std::int64_t> valid, const Hooks& hooks) const {
    const double scale = 1.0 / std::sqrt(static_cast<double>(width / heads));
    const T q = Operations<T>::scale(q_proj(x), static_cast<float>(scale));
    return out_proj(hooks.attention(q, k_proj(x), v_proj(x), heads, valid));
  }
};

/// One transformer layer, with its norms after each part or, in the stable form, before.
template <class T>
struct EncoderLayer {
  std::int64_t width = 0, inner = 0, heads = 1;
  double eps = 1e-5;
  bool stable = false;
  EncoderAttention<T> attention{width, heads};
  LayerNorm<T> layer_norm{width, eps};
  Linear<T> intermediate_dense{width, inner}, output_dense{inner, width};
  LayerNorm<T> final_layer_norm{width, eps};

  template <class V>
  void visit(V& v) {
    v.scope("attention", attention);
    v.scope("layer_norm", layer_norm);
    v.scope("feed_forward.intermediate_dense", intermediate_dense);
    v.scope("feed_forward.output_dense", output_dense);
    v.scope("final_layer_norm", final_layer_norm);
  }
  template <class Hooks>
  T feed_forward(const T& x, const Hooks& hooks) const {
    using B = Operations<T>;
    const T h = hooks.dropout(DropoutSite::activation, B::gelu(intermediate_dense(x)));
    return hooks.dropout(DropoutSite::hidden, output_dense(h));
  }
  /// h [.., T, D] -> [.., T, D]
  template <class Hooks>
  T operator()(const T& h, std::span<const std::int64_t> valid, const Hooks& hooks) const {
    using B = Operations<T>;
    const T a = hooks.dropout(DropoutSite::hidden, attention(stable ? layer_norm(h) : h, valid, hooks));
    if (stable) {
      const T x = B::add(h, a);
      return B::add(x, feed_forward(final_layer_norm(x), hooks));
    }
    const T x = layer_norm(B::add(h, a));
    return final_layer_norm(B::add(x, feed_forward(x, hooks)));
  }
};

/// The positional convolution, with its weight as length g and direction v of each tap (weight norm).
template <class T>
struct EncoderPositions {
  std::int64_t width = 0, kernel = 0, groups = 1;
  T bias{}, weight_g{}, weight_v{};

  template <class V>
  void visit(V& v) {
    v.tensor("conv.bias", bias, Shape{width}, Init::zero);
    v.tensor("conv.weight_g", weight_g, Shape{1, 1, kernel}, Init::one);
    v.tensor("conv.weight_v", weight_v, Shape{width, width / groups, kernel}, Init::fan_in);
  }
  /// h [.., T, D] -> [.., T, D]. Half a kernel of zeros on both sides would give one frame too many when the
  /// kernel is even; the original drops the last.
  T operator()(const T& h) const {
    using B = Operations<T>;
    const std::int64_t before = kernel / 2, after = kernel - 1 - before;
    return B::gelu(B::grouped_conv(h, B::weight_norm(weight_v, weight_g), bias, groups, before, after));
  }
};

template <class T>
struct SpeechEncoder {
  EncoderConfig config;
  T masked_spec_embed{};
  std::vector<EncoderConvLayer<T>> conv_layers;
  LayerNorm<T> projection_norm;  ///< unused without feat_proj_layer_norm
  Linear<T> projection;
  EncoderPositions<T> pos_conv_embed;
  LayerNorm<T> layer_norm;
  std::vector<EncoderLayer<T>> layers;

  /// @pre config.validate()
  explicit SpeechEncoder(const EncoderConfig& c)
      : config(c),
        projection_norm{c.conv_dim.back(), c.layer_norm_eps},
        projection{c.conv_dim.back(), c.hidden_size},
        pos_conv_embed{c.hidden_size, c.num_conv_pos_embeddings, c.num_conv_pos_embedding_groups},
        layer_norm{c.hidden_size, c.layer_norm_eps} {
    using Norm = typename EncoderConvLayer<T>::Norm;
    std::int64_t width = 1;
    for (std::size_t i = 0; i < c.conv_dim.size(); ++i) {
      const Norm norm = c.conv_layer_norm ? Norm::layer : i == 0 ? Norm::group : Norm::none;
      conv_layers.push_back({width, c.conv_dim[i], c.conv_kernel[i], c.conv_stride[i], c.conv_bias, norm});
      width = c.conv_dim[i];
    }
    for (std::int64_t i = 0; i < c.num_hidden_layers; ++i)
      layers.push_back({c.hidden_size, c.intermediate_size, c.num_attention_heads, c.layer_norm_eps,
                        c.do_stable_layer_norm});
  }

  template <class V>
  void visit(V& v) {
    v.optional("masked_spec_embed", masked_spec_embed, Shape{config.hidden_size}, Init::normal);
    v.scope("feature_extractor.conv_layers", conv_layers);
    if (config.feat_proj_layer_norm) v.scope("feature_projection.layer_norm", projection_norm);
    v.scope("feature_projection.projection", projection);
    v.scope("encoder.pos_conv_embed", pos_conv_embed);
    v.scope("encoder.layer_norm", layer_norm);
    v.scope("encoder.layers", layers);
  }

  /// The convolutions: waveform [.., S, 1] -> [.., T, C]. Normalise the waveform first if the configuration
  /// says so (normalise_waveform()). @pre S >= config.receptive_field()
  template <class Hooks = EvaluationHooks<T>>
  T extract(const T& waveform, const Hooks& hooks = {}) const {
    T x = waveform;
    for (std::size_t i = 0; i < conv_layers.size(); ++i) {
      x = conv_layers[i](x);
      hooks.stage("conv", static_cast<std::int64_t>(i), x);
    }
    return x;
  }

  /// The rest, up to the projection: [.., T, C] -> [.., T', D]. With the convolutions it is what fine-tuning
  /// keeps frozen, so training may compute it once per clip.
  template <class Hooks = EvaluationHooks<T>>
  T project(T x, const EncoderCall& call = {}, const Hooks& hooks = {}) const {
    using B = Operations<T>;
    if (call.num_frames > 0) {
      x = B::interpolate_rows(x, aligned_positions(B::num_rows(x), call.num_frames));
      hooks.stage("interpolated", 0, x);
    }
    if (config.feat_proj_layer_norm) x = projection_norm(x);
    x = projection(x);
    hooks.stage("projection", 0, x);
    return x;
  }

  /// The transformer: projected features [.., T, D] -> last hidden state [.., T, D].
  template <class Hooks = EvaluationHooks<T>>
  T transform(T h, const EncoderCall& call = {}, const Hooks& hooks = {}) const {
    using B = Operations<T>;
    h = hooks.dropout(DropoutSite::projection, std::move(h));
    if (!call.masked_frames.empty()) h = B::replace_rows(std::move(h), call.masked_frames, masked_spec_embed);
    h = B::zero_after(std::move(h), call.valid_frames);
    const T position = pos_conv_embed(h);
    hooks.stage("pos_conv", 0, position);
    h = B::add(std::move(h), position);
    if (!config.do_stable_layer_norm) {
      h = layer_norm(h);
      hooks.stage("encoder_layer_norm", 0, h);
    }
    h = hooks.dropout(DropoutSite::hidden, std::move(h));
    for (std::size_t i = 0; i < layers.size(); ++i) {
      if (call.skipped_layers.empty() || call.skipped_layers[i] == 0)
        h = layers[i](h, call.valid_frames, hooks);
      hooks.stage("layer", static_cast<std::int64_t>(i), h);
    }
    if (config.do_stable_layer_norm) {
      h = layer_norm(h);
      hooks.stage("encoder_layer_norm", 0, h);
    }
    return h;
  }

  /// All of it: waveform [.., S, 1] -> last hidden state [.., T, D], or [.., num_frames, D].
  template <class Hooks = EvaluationHooks<T>>
  T operator()(const T& waveform, const EncoderCall& call = {}, const Hooks& hooks = {}) const {
    return transform(project(extract(waveform, hooks), call, hooks), call, hooks);
  }

  /// Positions of `count` frames among `length`, first on first and last on last; one frame sits on the
  /// first.
  static std::vector<double> aligned_positions(std::int64_t length, std::int64_t count) {
    std::vector<double> positions(static_cast<std::size_t>(count), 0.0);
    for (std::int64_t i = 1; i < count; ++i)
      positions[static_cast<std::size_t>(i)] =
          static_cast<double>(i) * static_cast<double>(length - 1) / static_cast<double>(count - 1);
    return positions;
  }
};

}  // namespace mien
