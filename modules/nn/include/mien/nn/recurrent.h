#pragma once
#include <cstdint>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "mien/nn/operations.h"
#include "mien/nn/parameters.h"

namespace mien {

// Recurrent layers with the equations, names and gate orders of PyTorch. A layer maps x [.., N, in] to
// [.., N, hidden] and carries a state [.., 1, state_width(hidden)] from row to row, zeros at the start.

/// One layer of a gated recurrent unit, gate order reset, update, new.
template <class T>
struct GruLayer {
  std::int64_t in = 0, hidden = 0;
  std::string suffix{};  ///< of the parameter names: "_l0" in a stack of layers
  typename Operations<T>::Matrix w_ih{}, w_hh{};
  T b_ih{}, b_hh{};

  static std::int64_t state_width(std::int64_t hidden) { return hidden; }
  template <class V>
  void visit(V& v) {
    v.matrix("weight_ih" + suffix, w_ih, 3 * hidden, in, Init::fan_in);
    v.matrix("weight_hh" + suffix, w_hh, 3 * hidden, hidden, Init::fan_in);
    v.tensor("bias_ih" + suffix, b_ih, Shape{3 * hidden}, Init::zero);
    v.tensor("bias_hh" + suffix, b_hh, Shape{3 * hidden}, Init::zero);
  }

  /// x [.., N, in], state [.., 1, hidden] (updated) -> [.., N, hidden].
  T operator()(const T& x, T& state) const { return Operations<T>::gru(x, state, w_ih, w_hh, b_ih, b_hh); }
};

/// One layer of the plain recurrent network of Elman (1990): h' = tanh(W_ih x + b_ih + W_hh h + b_hh).
template <class T>
struct RnnLayer {
  std::int64_t in = 0, hidden = 0;
  std::string suffix{};
  typename Operations<T>::Matrix w_ih{}, w_hh{};
  T b_ih{}, b_hh{};

  static std::int64_t state_width(std::int64_t hidden) { return hidden; }
  template <class V>
  void visit(V& v) {
    v.matrix("weight_ih" + suffix, w_ih, hidden, in, Init::fan_in);
    v.matrix("weight_hh" + suffix, w_hh, hidden, hidden, Init::fan_in);
    v.tensor("bias_ih" + suffix, b_ih, Shape{hidden}, Init::zero);
    v.tensor("bias_hh" + suffix, b_hh, Shape{hidden}, Init::zero);
  }

  T operator()(const T& x, T& state) const {
    using B = Operations<T>;
    const T projected = B::linear(x, w_ih, b_ih);
    std::vector<T> out;
    for (std::int64_t n = 0; n < B::num_rows(x); ++n) {
      state = B::tanh(B::add(B::rows(projected, n, 1), B::linear(state, w_hh, b_hh)));
      out.push_back(state);
    }
    return out.empty() ? B::zero_rows(x, 0, hidden) : B::concat_rows(out);
  }
};

/// One layer of long short-term memory (Hochreiter and Schmidhuber 1997), gate order input, forget, cell,
/// output. The state is h beside c.
template <class T>
struct LstmLayer {
  std::int64_t in = 0, hidden = 0;
  std::string suffix{};
  typename Operations<T>::Matrix w_ih{}, w_hh{};
  T b_ih{}, b_hh{};

  static std::int64_t state_width(std::int64_t hidden) { return 2 * hidden; }
  template <class V>
  void visit(V& v) {
    v.matrix("weight_ih" + suffix, w_ih, 4 * hidden, in, Init::fan_in);
    v.matrix("weight_hh" + suffix, w_hh, 4 * hidden, hidden, Init::fan_in);
    v.tensor("bias_ih" + suffix, b_ih, Shape{4 * hidden}, Init::zero);
    v.tensor("bias_hh" + suffix, b_hh, Shape{4 * hidden}, Init::zero);
  }

  T operator()(const T& x, T& state) const {
    using B = Operations<T>;
    const T projected = B::linear(x, w_ih, b_ih);
    T h = B::columns(state, 0, hidden), c = B::columns(state, hidden, hidden);
    std::vector<T> out;
    for (std::int64_t n = 0; n < B::num_rows(x); ++n) {
      const T gates = B::add(B::rows(projected, n, 1), B::linear(h, w_hh, b_hh));
      const auto gate = [&](std::int64_t i) { return B::columns(gates, i * hidden, hidden); };
      c = B::add(B::mul(B::sigmoid(gate(1)), c), B::mul(B::sigmoid(gate(0)), B::tanh(gate(2))));
      h = B::mul(B::sigmoid(gate(3)), B::tanh(c));
      out.push_back(h);
    }
    state = B::concat_columns({h, c});
    return out.empty() ? B::zero_rows(x, 0, hidden) : B::concat_rows(out);
  }
};

/// Layers one on the other, with PyTorch's names: weight_ih_l0, weight_ih_l1 ...
template <template <class> class Layer, class T>
struct RecurrentStack {
  std::int64_t in = 0, hidden = 0;
  std::vector<Layer<T>> layers;

  RecurrentStack(std::int64_t inputs, std::int64_t width, std::int64_t num_layers)
      : in(inputs), hidden(width) {
    for (std::int64_t i = 0; i < num_layers; ++i)
      layers.push_back({i == 0 ? inputs : width, width, "_l" + std::to_string(i)});
  }
  template <class V>
  void visit(V& v) {
    for (auto& layer : layers) layer.visit(v);
  }

  /// x [.., N, in] -> [.., N, hidden]. `states`: what the layers remember (updated); empty at the start, when
  /// they are zeros. `between` changes what each layer but the last gives to the next (dropout in training).
  template <class Between>
  T operator()(T x, std::vector<T>& states, Between&& between) const {
    using B = Operations<T>;
    for (std::size_t i = 0; i < layers.size(); ++i) {
      if (states.size() <= i) states.push_back(B::zero_rows(x, 1, Layer<T>::state_width(hidden)));
      x = layers[i](x, states[i]);
      if (i + 1 < layers.size()) x = between(std::move(x));
    }
    return x;
  }
  T operator()(const T& x, std::vector<T>& states) const {
    return (*this)(x, states, [](T y) { return y; });
  }
  template <class Between>
  requires std::is_invocable_r_v<T, Between, T> T operator()(const T& x, Between&& between) const {
    std::vector<T> states;
    return (*this)(x, states, between);
  }
  T operator()(const T& x) const {
    std::vector<T> states;
    return (*this)(x, states);
  }
};

template <class T>
using Gru = RecurrentStack<GruLayer, T>;
template <class T>
using Rnn = RecurrentStack<RnnLayer, T>;
template <class T>
using Lstm = RecurrentStack<LstmLayer, T>;

}  // namespace mien
