#pragma once
#include <cmath>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>

#include "mien/base/result.h"
#include "mien/io/safetensors.h"
#include "mien/models/said/alignment.h"
#include "mien/nn/layers.h"

// The denoiser of SAiD (Park and Cho 2024) behind its speech encoder: an estimate of the noise in a sequence
// of blendshape coefficients, from the noisy sequence, the number of the diffusion step and speech. The U-Net
// of latent diffusion on one level, so nothing is sampled down or up. Letters: N frames of motion, K
// coefficients, C width, T frames of context, D width of the context. Names are those of the checkpoint.
namespace mien::said {

struct Sizes {
  std::int64_t num_channels = 32;  ///< K
  std::int64_t width = 192;        ///< C
  std::int64_t context = 768;      ///< D
  std::int64_t time = 768;         ///< of the embedding of a step
  std::int64_t inner = 768;        ///< of the feed-forward parts, behind their gate
  std::int64_t speech = 768;       ///< of the encoder's features; more than D only with audio_proj_layer
  bool has_projection = false;     ///< audio_proj_layer stands between encoder and denoiser
  /// A frame looks at its own speech and that beside it. False in the paper's ablation without alignment
  /// bias, where it looks at all; shapes do not tell.
  bool is_aligned = true;

  /// The frames of context that each frame of motion looks at.
  [[nodiscard]] std::vector<KeyRange> seen_keys(std::int64_t num_frames, std::int64_t num_context) const {
    if (is_aligned) return aligned_keys(num_frames, num_context);
    return std::vector<KeyRange>(static_cast<std::size_t>(num_frames), KeyRange{0, num_context});
  }

  static constexpr std::int64_t kHeadWidth = 32;  ///< fixed in the original
  static constexpr std::int64_t kGroups = 32;     ///< of the group norms, too
  [[nodiscard]] std::int64_t num_heads() const { return width / kHeadWidth; }
};

/// Read from names and shapes of the stored tensors. Errors (Errc::incompatible): weights of no such
/// denoiser.
Result<Sizes> sizes_of(const std::map<std::string, Shape>& shapes);
Result<Sizes> sizes_of(const SafetensorsFile& file);

/// What happens inside a pass: nothing, when it runs. Training passes an object with the same functions that
/// drops values in the residual blocks (0.1); tests pass one that keeps every stage.
template <class T>
struct PassHooks {
  T dropout(T x) const { return x; }
  /// Called with the name of a module ("middle_block.1"), of a part of it ("attn1") or nothing, and its
  /// output.
  void stage(std::string_view /*module*/, std::string_view /*part*/, const T& /*x*/) const {}
};

template <class T>
struct ResBlock {
  std::int64_t in = 0, out = 0, time = 0;
  GroupNorm<T> in_norm{in, Sizes::kGroups};
  Conv<T> in_conv{in, out, 3};
  Linear<T> step{time, out};
  GroupNorm<T> out_norm{out, Sizes::kGroups};
  Conv<T> out_conv{out, out, 3, Init::zero};
  Conv<T> skip{in, out, 1};  ///< where the widths differ

  template <class V>
  void visit(V& v) {
    v.scope("in_layers.0", in_norm);
    v.scope("in_layers.2", in_conv);
    v.scope("emb_layers.1", step);
    v.scope("out_layers.0", out_norm);
    v.scope("out_layers.3", out_conv);
    if (in != out) v.scope("skip_connection", skip);
  }
  /// x [.., N, in], embedding of the step behind its SiLU [.., 1, time] -> [.., N, out]
  template <class Hooks>
  T operator()(const T& x, const T& embedding, const Hooks& hooks) const {
    using B = Operations<T>;
    const T h = B::add(in_conv(B::silu(in_norm(x))), step(embedding));
    const T y = out_conv(hooks.dropout(B::silu(out_norm(h))));
    return B::add(y, in == out ? x : skip(x));
  }
};

/// Attention to the motion itself, or to the speech.
template <class T>
struct Attention {
  std::int64_t width = 0, source = 0;
  Linear<T> to_q{width, width, Init::fan_in, false}, to_k{source, width, Init::fan_in, false},
      to_v{source, width, Init::fan_in, false};
  Linear<T> to_out{width, width};

  template <class V>
  void visit(V& v) {
    v.scope("to_q", to_q);
    v.scope("to_k", to_k);
    v.scope("to_v", to_v);
    v.scope("to_out.0", to_out);
  }
  [[nodiscard]] T queries(const T& y) const {
    const double scale = 1.0 / std::sqrt(static_cast<double>(Sizes::kHeadWidth));
    return Operations<T>::scale(to_q(y), static_cast<float>(scale));
  }
  /// y [.., N, width] -> [.., N, width], every frame seeing all
  T operator()(const T& y) const {
    return to_out(Operations<T>::attention(queries(y), to_k(y), to_v(y), width / Sizes::kHeadWidth, {}));
  }
  /// The same to a context [.., T, source], frame n seeing `ranges`[n] of it.
  T operator()(const T& y, const T& context, std::span<const KeyRange> ranges) const {
    return to_out(Operations<T>::attention_within(queries(y), to_k(context), to_v(context),
                                                  width / Sizes::kHeadWidth, ranges));
  }
};

/// Linear, one half gated by the GELU of the other, linear.
template <class T>
struct GatedFeedForward {
  std::int64_t width = 0, inner = 0;
  Linear<T> expand{width, 2 * inner}, contract{inner, width};

  template <class V>
  void visit(V& v) {
    v.scope("net.0.proj", expand);
    v.scope("net.2", contract);
  }
  T operator()(const T& y) const {
    using B = Operations<T>;
    const T both = expand(y);
    return contract(B::mul(B::columns(both, 0, inner), B::gelu(B::columns(both, inner, inner))));
  }
};

/// Self attention, attention to the speech and a feed-forward part, each with its norm before and added to
/// its input; then one 1 x 1 convolution, added to the block's input. Unlike in latent diffusion there is no
/// projection in front.
template <class T>
struct TransformerBlock {
  std::int64_t width = 0, context = 0, inner = 0;
  GroupNorm<T> norm{width, Sizes::kGroups, 1e-6};
  Attention<T> attn1{width, width};
  GatedFeedForward<T> ff{width, inner};
  Attention<T> attn2{width, context};
  LayerNorm<T> norm1{width}, norm2{width}, norm3{width};
  Conv<T> proj_out{width, width, 1, Init::zero};

  template <class V>
  void visit(V& v) {
    v.scope("norm", norm);
    v.scope("transformer_blocks.0.attn1", attn1);
    v.scope("transformer_blocks.0.ff", ff);
    v.scope("transformer_blocks.0.attn2", attn2);
    v.scope("transformer_blocks.0.norm1", norm1);
    v.scope("transformer_blocks.0.norm2", norm2);
    v.scope("transformer_blocks.0.norm3", norm3);
    v.scope("proj_out", proj_out);
  }
  /// x [.., N, width], context [.., T, D] -> [.., N, width]
  template <class Hooks>
  T operator()(const T& x, const T& speech, std::span<const KeyRange> ranges, std::string_view name,
               const Hooks& hooks) const {
    using B = Operations<T>;
    const auto part = [&](const char* part_name, T value) {
      hooks.stage(name, part_name, value);
      return value;
    };
    T y = part("norm", norm(x));
    y = B::add(part("attn1", attn1(norm1(y))), y);
    y = B::add(part("attn2", attn2(norm2(y), speech, ranges)), y);
    y = B::add(part("ff", ff(norm3(y))), y);
    return B::add(proj_out(y), x);
  }
};

/// The denoiser, "denoiser.model." in a checkpoint.
template <class T>
struct Denoiser {
  Sizes sizes;
  using Res = ResBlock<T>;
  using Mix = TransformerBlock<T>;
  Linear<T> time_in{sizes.width, sizes.time}, time_out{sizes.time, sizes.time};
  Conv<T> input{sizes.num_channels, sizes.width, 3};
  Res encoder_res{sizes.width, sizes.width, sizes.time};
  Mix encoder_mix{sizes.width, sizes.context, sizes.inner};
  Res middle_res{sizes.width, sizes.width, sizes.time};
  Mix middle_mix{sizes.width, sizes.context, sizes.inner};
  Res middle_res2{sizes.width, sizes.width, sizes.time};
  Res decoder_res{2 * sizes.width, sizes.width, sizes.time};
  Mix decoder_mix{sizes.width, sizes.context, sizes.inner};
  Res decoder_res2{2 * sizes.width, sizes.width, sizes.time};
  Mix decoder_mix2{sizes.width, sizes.context, sizes.inner};
  GroupNorm<T> out_norm{sizes.width, Sizes::kGroups};
  Conv<T> out{sizes.width, sizes.num_channels, 3, Init::zero};

  explicit Denoiser(const Sizes& s) : sizes(s) {}
  template <class V>
  void visit(V& v) {
    v.scope("time_embed.0", time_in);
    v.scope("time_embed.2", time_out);
    v.scope("input_blocks.0.0", input);
    v.scope("input_blocks.1.0", encoder_res);
    v.scope("input_blocks.1.1", encoder_mix);
    v.scope("middle_block.0", middle_res);
    v.scope("middle_block.1", middle_mix);
    v.scope("middle_block.2", middle_res2);
    v.scope("output_blocks.0.0", decoder_res);
    v.scope("output_blocks.0.1", decoder_mix);
    v.scope("output_blocks.1.0", decoder_res2);
    v.scope("output_blocks.1.1", decoder_mix2);
    v.scope("out.0", out_norm);
    v.scope("out.2", out);
  }

  /// Embedding of step numbers, one or one for each batch of `like` -> [.., 1, time].
  T step_embedding(const T& like, std::span<const std::int64_t> steps) const {
    using B = Operations<T>;
    const std::vector<float> sinusoids = step_sinusoids(steps, sizes.width);
    return time_out(B::silu(time_in(B::given_rows(like, sinusoids, sizes.width))));
  }

  /// x_t [.., N, K], step numbers, context [.., T, D] -> the noise in x_t [.., N, K].
  template <class Hooks = PassHooks<T>>
  T operator()(const T& x_t, std::span<const std::int64_t> steps, const T& context,
               const Hooks& hooks = {}) const {
    using B = Operations<T>;
    const std::vector<KeyRange> ranges = sizes.seen_keys(B::num_rows(x_t), B::num_rows(context));
    const auto kept = [&](std::string_view name, T value) {
      hooks.stage(name, "", value);
      return value;
    };
    const auto res = [&](std::string_view name, const Res& block, const T& x, const T& embedding) {
      return kept(name, block(x, embedding, hooks));
    };
    const auto mix = [&](std::string_view name, const Mix& block, const T& x) {
      return kept(name, block(x, context, ranges, name, hooks));
    };
    const T step = B::silu(kept("time_embed", step_embedding(x_t, steps)));
    const T h0 = kept("input_blocks.0", input(x_t));
    const T h1 = mix("input_blocks.1.1", encoder_mix, res("input_blocks.1.0", encoder_res, h0, step));
    T m = mix("middle_block.1", middle_mix, res("middle_block.0", middle_res, h1, step));
    m = res("middle_block.2", middle_res2, m, step);
    const T u = mix("output_blocks.0.1", decoder_mix,
                    res("output_blocks.0.0", decoder_res, B::concat_columns({m, h1}), step));
    const T w = mix("output_blocks.1.1", decoder_mix2,
                    res("output_blocks.1.0", decoder_res2, B::concat_columns({u, h0}), step));
    return out(B::silu(out_norm(w)));
  }
};

/// Everything of SAiD but the speech encoder.
template <class T>
struct Network {
  Sizes sizes;
  T null_condition{};  ///< [1, 1, D]: a frame of context when there is no speech
  Linear<T> projection{sizes.speech, sizes.context};
  Denoiser<T> denoiser{sizes};

  explicit Network(const Sizes& s) : sizes(s) {}
  template <class V>
  void visit(V& v) {
    v.tensor("null_cond_emb", null_condition, Shape{1, 1, sizes.context}, Init::unit_normal);
    if (sizes.has_projection) v.scope("audio_proj_layer", projection);
    v.scope("denoiser.model", denoiser);
  }

  /// Features of the speech encoder at the frame rate of the motion [.., N, speech] -> context [.., N, D].
  T context(const T& features) const { return sizes.has_projection ? projection(features) : features; }
  /// The context of no speech, for as many frames and batches as `like` has.
  T null_context(const T& like) const {
    using B = Operations<T>;
    return B::add(B::zero_rows(like, B::num_rows(like), sizes.context), null_condition);
  }
};

}  // namespace mien::said
