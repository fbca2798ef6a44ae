#pragma once
#include <cmath>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "mien/nn/layers.h"
#include "mien/tensor/key_range.h"

namespace mien {

/// Row t of the sinusoid table of Vaswani et al. (2017), section 3.5: sin(t w) in even, cos(t w) in odd
/// columns, w = 10000^(-2j / width) for the pair j.
inline std::vector<float> sinusoid_row(std::int64_t t, std::int64_t width) {
  std::vector<float> row(static_cast<std::size_t>(width));
  for (std::int64_t c = 0; c < width; ++c) {
    const double omega =
        std::exp(-static_cast<double>(c - c % 2) * std::log(10000.0) / static_cast<double>(width));
    const double angle = static_cast<double>(t) * omega;
    row[static_cast<std::size_t>(c)] = static_cast<float>(c % 2 == 0 ? std::sin(angle) : std::cos(angle));
  }
  return row;
}

/// Rows first ... first + count - 1 of that table, [.., count, width].
template <class T>
T sinusoid_rows(const T& like, std::int64_t first, std::int64_t count, std::int64_t width) {
  using B = Operations<T>;
  std::vector<T> rows;
  for (std::int64_t n = 0; n < count; ++n)
    rows.push_back(B::given_rows(like, sinusoid_row(first + n, width), width));
  return rows.empty() ? B::zero_rows(like, 0, width) : B::concat_rows(rows);
}

/// What an attention may look at, projected once: keys and values [.., T, width].
template <class T>
struct AttentionMemory {
  T keys, values;
};

/// Scaled dot-product attention with heads, all four maps with bias.
template <class T>
struct MultiHeadAttention {
  std::int64_t width = 0, heads = 1;
  Linear<T> q_proj{width, width}, k_proj{width, width}, v_proj{width, width}, out_proj{width, width};

  template <class V>
  void visit(V& v) {
    v.scope("q_proj", q_proj);
    v.scope("k_proj", k_proj);
    v.scope("v_proj", v_proj);
    v.scope("out_proj", out_proj);
  }
  AttentionMemory<T> remember(const T& x) const { return {k_proj(x), v_proj(x)}; }
  /// x [.., N, width] -> [.., N, width]; query n sees the keys ranges[n], with no ranges all.
  T operator()(const T& x, const AttentionMemory<T>& memory, std::span<const KeyRange> ranges = {}) const {
    using B = Operations<T>;
    const double factor = 1 / std::sqrt(static_cast<double>(width / heads));
    const T q = B::scale(q_proj(x), static_cast<float>(factor));
    return out_proj(ranges.empty() ? B::attention(q, memory.keys, memory.values, heads, {})
                                   : B::attention_within(q, memory.keys, memory.values, heads, ranges));
  }
};

/// One layer of a decoder as in PyTorch's TransformerDecoderLayer: self-attention that looks backwards,
/// attention to a memory, two linear maps with a rectifier; a norm behind each.
template <class T>
struct TransformerDecoderLayer {
  std::int64_t width = 0, heads = 1, inner = 0;
  MultiHeadAttention<T> self_attn{width, heads}, multihead_attn{width, heads};
  Linear<T> linear1{width, inner}, linear2{inner, width};
  LayerNorm<T> norm1{width}, norm2{width}, norm3{width};

  template <class V>
  void visit(V& v) {
    v.scope("self_attn", self_attn);
    v.scope("multihead_attn", multihead_attn);
    v.scope("linear1", linear1);
    v.scope("linear2", linear2);
    v.scope("norm1", norm1);
    v.scope("norm2", norm2);
    v.scope("norm3", norm3);
  }
};

/// A stack of such layers that writes a sequence row by row from what it wrote before, over a memory.
template <class T>
struct TransformerDecoder {
  std::int64_t in = 0;        ///< of the memory
  std::int64_t feedback = 0;  ///< of a written row
  std::int64_t width = 0, heads = 1;
  Linear<T> memory_map{in, width}, feedback_map{feedback, width};
  std::vector<TransformerDecoderLayer<T>> layers;

  TransformerDecoder(std::int64_t memory, std::int64_t row, std::int64_t hidden, std::int64_t num_layers,
                     std::int64_t num_heads)
      : in(memory), feedback(row), width(hidden), heads(num_heads) {
    for (std::int64_t i = 0; i < num_layers; ++i) layers.push_back({width, heads, inner_width(width)});
  }
  /// Of the two linear maps: twice the width, as in FaceFormer (Fan et al. 2022).
  static std::int64_t inner_width(std::int64_t width) { return 2 * width; }
  template <class V>
  void visit(V& v) {
    v.scope("memory_map", memory_map);
    v.scope("feedback_map", feedback_map);
    v.scope("layers", layers);
  }

  /// Where a sequence stands.
  struct State {
    std::vector<AttentionMemory<T>> memory, past;  ///< by layer; past: of the rows read so far
    std::int64_t num_rows = 0;
  };
  /// memory [.., N, in]
  State begin(const T& memory) const {
    using B = Operations<T>;
    const T mapped = memory_map(memory);
    const T placed = B::add(mapped, sinusoid_rows(mapped, 0, B::num_rows(mapped), width));
    State state;
    for (const auto& layer : layers) state.memory.push_back(layer.multihead_attn.remember(placed));
    return state;
  }
  /// The next rows: row i reads rows[i], the row that was written before it, and what came before.
  /// rows [.., n, feedback] -> [.., n, width]. `drop` (none: nothing) drops values in training.
  T next(const T& rows, State& state, const std::function<T(T)>& drop = nullptr) const {
    using B = Operations<T>;
    const std::int64_t count = B::num_rows(rows);
    const auto dropped = [&](T x) { return drop ? drop(std::move(x)) : x; };
    std::vector<KeyRange> backwards;
    for (std::int64_t i = 0; i < count; ++i) backwards.push_back({0, state.num_rows + i + 1});
    const T mapped = feedback_map(rows);
    T h = dropped(B::add(mapped, sinusoid_rows(mapped, state.num_rows, count, width)));
    for (std::size_t i = 0; i < layers.size(); ++i) {
      const TransformerDecoderLayer<T>& layer = layers[i];
      AttentionMemory<T> seen = layer.self_attn.remember(h);
      if (state.past.size() > i)
        seen = {B::concat_rows({state.past[i].keys, seen.keys}),
                B::concat_rows({state.past[i].values, seen.values})};
      else
        state.past.resize(i + 1);
      state.past[i] = seen;
      h = layer.norm1(B::add(h, dropped(layer.self_attn(h, seen, backwards))));
      h = layer.norm2(B::add(h, dropped(layer.multihead_attn(h, state.memory[i]))));
      h = layer.norm3(B::add(h, dropped(layer.linear2(dropped(B::relu(layer.linear1(h)))))));
    }
    state.num_rows += count;
    return h;
  }
};

}  // namespace mien
