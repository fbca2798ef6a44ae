#pragma once
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "mien/models/probtalk3d/positions.h"
#include "mien/nn/channel_operations.h"
#include "mien/nn/layers.h"

// What the motion networks of ProbTalk3D (Wu et al. 2024) are made of. Letters: N frames, D latent width. All
// of it looks at the whole clip: attention and the norm over time see every frame.
namespace mien::probtalk3d {

/// What happens inside the networks: nothing, when they run. Training passes an object with the same
/// functions whose dropout() drops values; tests pass one that keeps every stage.
template <class T>
struct EvaluationHooks {
  T dropout(T x) const { return x; }
  void stage(const char* /*name*/, const T& /*x*/) const {}
};

inline constexpr float kLeakySlope = 0.2f;
inline constexpr double kInstanceNormEps = 1e-5;

/// Convolution over time with the end frames repeated outside, leaky ReLU, and a norm of every channel over
/// the frames of this clip, also when the network runs ("squasher" and "expander" in the original, which
/// change no length: its quant_factor is 0).
template <class T>
struct ConvBlock {
  std::int64_t width = 0, kernel = 5;
  typename Operations<T>::Matrix weight{};
  T bias{};

  template <class V>
  void visit(V& v) {
    v.convolution("weight", weight, width, width, kernel, Init::fan_in);
    v.tensor("bias", bias, Shape{width}, Init::fan_in);
  }
  /// x [.., N, D] -> [.., N, D]. @pre N > 0; with one frame the norm leaves zeros.
  template <class Hooks>
  T operator()(const T& x, const Hooks& hooks) const {
    using B = Operations<T>;
    const std::int64_t last = B::num_rows(x) - 1;
    std::vector<T> parts;
    for (std::int64_t i = 0; i < kernel / 2; ++i) parts.push_back(B::rows(x, 0, 1));
    parts.push_back(x);
    for (std::int64_t i = 0; i < kernel - 1 - kernel / 2; ++i) parts.push_back(B::rows(x, last, 1));
    const T y = B::conv(B::concat_rows(parts), weight, bias, kernel, 1);
    hooks.stage("conv", y);
    using C = ChannelOperations<T>;
    return C::instance_norm(C::leaky_relu(y, kLeakySlope), kInstanceNormEps);
  }
};

/// x + to_out(attention(norm(x))).
template <class T>
struct SelfAttention {
  std::int64_t width = 0, heads = 1;
  LayerNorm<T> norm{width};
  typename Operations<T>::Matrix to_qkv{};  ///< [3 D, D]: queries, keys, values
  T none{};                                 // a fixed zero bias, not a parameter
  Linear<T> to_out{width, width};

  template <class V>
  void visit(V& v) {
    v.scope("fn.norm", norm);
    v.matrix("fn.fn.to_qkv.weight", to_qkv, 3 * width, width, Init::fan_in);
    v.scope("fn.fn.to_out", to_out);
  }
  T operator()(const T& x) const {
    using B = Operations<T>;
    const T qkv = B::linear(norm(x), to_qkv, none);
    // The scale is that of the whole width, not of a head's.
    const auto scale = static_cast<float>(1.0 / std::sqrt(static_cast<double>(width)));
    const T mixed = B::attention(B::scale(B::columns(qkv, 0, width), scale), B::columns(qkv, width, width),
                                 B::columns(qkv, 2 * width, width), heads, {});
    return B::add(x, to_out(mixed));
  }
};

/// x + l2(gelu(l1(norm(x)))), with the tanh form of GELU.
template <class T>
struct FeedForward {
  std::int64_t width = 0, inner = 0;
  LayerNorm<T> norm{width};
  Linear<T> l1{width, inner}, l2{inner, width};

  template <class V>
  void visit(V& v) {
    v.scope("fn.norm", norm);
    v.scope("fn.fn.l1", l1);
    v.scope("fn.fn.l2", l2);
  }
  T operator()(const T& x) const {
    using B = Operations<T>;
    return B::add(x, l2(B::gelu_tanh(l1(norm(x)))));
  }
};

/// Sizes of a transformer stack, which all three networks have behind a ConvBlock.
struct StackSizes {
  std::int64_t width = 0, inner = 0, heads = 1, num_blocks = 0;
};

/// ConvBlock, linear map, positions, transformer blocks without a norm behind the last.
template <class T>
struct MotionStack {
  StackSizes sizes;
  std::string conv_name;  ///< "squasher" before codes, "expander" behind
  std::string role;       ///< "encoder" or "decoder": how the other names begin
  ConvBlock<T> conv{sizes.width};
  Linear<T> embedding{sizes.width, sizes.width};
  std::vector<SelfAttention<T>> attention;
  std::vector<FeedForward<T>> feed_forward;

  MotionStack(const StackSizes& s, std::string conv_block, std::string prefix)
      : sizes(s), conv_name(std::move(conv_block)), role(std::move(prefix)) {
    for (std::int64_t i = 0; i < s.num_blocks; ++i) {
      attention.push_back({s.width, s.heads});
      feed_forward.push_back({s.width, s.inner});
    }
  }

  template <class V>
  void visit(V& v) {
    v.scope(conv_name + ".0.0", conv);
    v.scope(role + "_linear_embedding.net", embedding);
    for (std::size_t i = 0; i < attention.size(); ++i) {
      v.scope(role + "_transformer.net." + std::to_string(2 * i), attention[i]);
      v.scope(role + "_transformer.net." + std::to_string(2 * i + 1), feed_forward[i]);
    }
  }

  /// x [.., N, D] -> [.., N, D]. @pre N > 0
  template <class Hooks>
  T operator()(const T& x, const Hooks& hooks) const {
    using B = Operations<T>;
    T h = conv(x, hooks);
    hooks.stage("conv_lrelu_in", h);
    h = embedding(h);
    hooks.stage("linear_embedding", h);
    const std::int64_t num_frames = B::num_rows(h);
    h = B::add(h, B::constant_rows(h, position_table(num_frames, sizes.width), sizes.width));
    hooks.stage("after_pos", h);
    h = hooks.dropout(std::move(h));
    for (std::size_t i = 0; i < attention.size(); ++i) {
      h = attention[i](h);
      hooks.stage("net", h);
      h = feed_forward[i](h);
      hooks.stage("net", h);
    }
    return h;
  }
};

}  // namespace mien::probtalk3d
