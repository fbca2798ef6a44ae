#pragma once
#include <cstdint>
#include <vector>

#include "mien/nn/operations.h"
#include "mien/nn/parameters.h"

namespace mien {

/// y = x W^T + b. x [.., N, in] -> [.., N, out].
template <class T>
struct Linear {
  std::int64_t in = 0, out = 0;
  Init init = Init::fan_in;
  typename Operations<T>::Matrix weight{};
  T bias{};

  template <class V>
  void visit(V& v) {
    v.matrix("weight", weight, out, in, init);
    v.tensor("bias", bias, Shape{out}, init == Init::zero ? Init::zero : Init::fan_in);
  }
  T operator()(const T& x) const { return Operations<T>::linear(x, weight, bias); }
};

/// Normalises each row over its channels, then y = gamma x + beta.
template <class T>
struct LayerNorm {
  std::int64_t width = 0;
  T gamma{}, beta{};

  template <class V>
  void visit(V& v) {
    v.tensor("weight", gamma, Shape{width}, Init::one);
    v.tensor("bias", beta, Shape{width}, Init::zero);
  }
  T operator()(const T& x) const { return Operations<T>::layer_norm(x, gamma, beta); }
};

/// One layer of a gated recurrent unit, gate order reset, update, new (as in PyTorch).
template <class T>
struct GruLayer {
  std::int64_t in = 0, hidden = 0;
  typename Operations<T>::Matrix w_ih{}, w_hh{};
  T b_ih{}, b_hh{};

  template <class V>
  void visit(V& v) {
    v.matrix("weight_ih", w_ih, 3 * hidden, in, Init::fan_in);
    v.matrix("weight_hh", w_hh, 3 * hidden, hidden, Init::fan_in);
    v.tensor("bias_ih", b_ih, Shape{3 * hidden}, Init::zero);
    v.tensor("bias_hh", b_hh, Shape{3 * hidden}, Init::zero);
  }

  /// x [.., N, in], state [.., 1, hidden] (updated) -> [.., N, hidden].
  T operator()(const T& x, T& state) const {
    using B = Operations<T>;
    const T input_gates = B::linear(x, w_ih, b_ih);
    std::vector<T> outputs;
    for (std::int64_t n = 0; n < B::num_rows(x); ++n) {
      const T gi = B::rows(input_gates, n, 1);
      const T gh = B::linear(state, w_hh, b_hh);
      const T reset = B::sigmoid(B::add(B::columns(gi, 0, hidden), B::columns(gh, 0, hidden)));
      const T update = B::sigmoid(B::add(B::columns(gi, hidden, hidden), B::columns(gh, hidden, hidden)));
      const T fresh = B::tanh(
          B::add(B::columns(gi, 2 * hidden, hidden), B::mul(reset, B::columns(gh, 2 * hidden, hidden))));
      // (1 - update) fresh + update state
      state = B::add(fresh, B::mul(update, B::add(state, B::scale(fresh, -1.0f))));
      outputs.push_back(state);
    }
    return B::concat_rows(outputs);
  }
};

/// A table of rows chosen by weights: one-hot weights give the usual lookup, intensities scale an entry.
/// weights [.., N, entries] -> [.., N, width].
template <class T>
struct WeightedEmbedding {
  std::int64_t entries = 0, width = 0;
  typename Operations<T>::Matrix table{};  // [width, entries]
  T none{};                                // a fixed zero bias, not a parameter

  template <class V>
  void visit(V& v) {
    v.matrix("weight", table, width, entries, Init::normal);
  }
  T operator()(const T& weights) const { return Operations<T>::linear(weights, table, none); }
};

}  // namespace mien
