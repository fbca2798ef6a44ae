#pragma once
#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

#include "mien/nn/operations.h"
#include "mien/nn/parameters.h"

namespace mien {

/// y = x W^T + b. x [.., N, in] -> [.., N, out].
template <class T>
struct Linear {
  std::int64_t in = 0, out = 0;
  Init init = Init::fan_in;
  bool has_bias = true;
  typename Operations<T>::Matrix weight{};
  T bias{};

  template <class V>
  void visit(V& v) {
    v.matrix("weight", weight, out, in, init);
    if (has_bias) v.tensor("bias", bias, Shape{out}, init == Init::zero ? Init::zero : Init::fan_in);
  }
  T operator()(const T& x) const { return Operations<T>::linear(x, weight, bias); }
};

/// A convolution over time with zeros outside, so that the number of frames stays. x [.., N, in] -> [.., N,
/// out]. @pre kernel is odd
template <class T>
struct Conv {
  std::int64_t in = 0, out = 0, kernel = 1;
  Init init = Init::fan_in;
  typename Operations<T>::Matrix weight{};
  T bias{};

  template <class V>
  void visit(V& v) {
    v.convolution("weight", weight, out, in, kernel, init);
    v.tensor("bias", bias, Shape{out}, init == Init::zero ? Init::zero : Init::fan_in);
  }
  T operator()(const T& x) const {
    using B = Operations<T>;
    if (kernel == 1) return B::conv(x, weight, bias, 1, 1);
    const T zeros = B::zero_rows(x, kernel / 2, in);
    return B::conv(B::concat_rows({zeros, x, zeros}), weight, bias, kernel, 1);
  }
};

/// Normalises groups of neighbouring channels over all frames, then y = gamma x + beta by channel.
template <class T>
struct GroupNorm {
  std::int64_t width = 0, groups = 1;
  double eps = 1e-5;
  T gamma{}, beta{};

  template <class V>
  void visit(V& v) {
    v.tensor("weight", gamma, Shape{width}, Init::one);
    v.tensor("bias", beta, Shape{width}, Init::zero);
  }
  T operator()(const T& x) const { return Operations<T>::group_norm(x, gamma, beta, groups, eps); }
};

/// Normalises each row over its channels, then y = gamma x + beta.
template <class T>
struct LayerNorm {
  std::int64_t width = 0;
  double eps = 1e-5;
  T gamma{}, beta{};

  template <class V>
  void visit(V& v) {
    v.tensor("weight", gamma, Shape{width}, Init::one);
    v.tensor("bias", beta, Shape{width}, Init::zero);
  }
  T operator()(const T& x) const { return Operations<T>::layer_norm(x, gamma, beta, eps); }
};

/// One layer of a gated recurrent unit, gate order reset, update, new (as in PyTorch).
template <class T>
struct GruLayer {
  std::int64_t in = 0, hidden = 0;
  std::string suffix{};  ///< of the parameter names: "_l0" in a Gru of several layers
  typename Operations<T>::Matrix w_ih{}, w_hh{};
  T b_ih{}, b_hh{};

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

/// GRU layers one on the other, with PyTorch's names: weight_ih_l0, weight_ih_l1 ...
template <class T>
struct Gru {
  std::int64_t in = 0, hidden = 0;
  std::vector<GruLayer<T>> layers;

  Gru(std::int64_t inputs, std::int64_t width, std::int64_t num_layers) : in(inputs), hidden(width) {
    for (std::int64_t i = 0; i < num_layers; ++i)
      layers.push_back({i == 0 ? inputs : width, width, "_l" + std::to_string(i)});
  }
  template <class V>
  void visit(V& v) {
    for (auto& layer : layers) layer.visit(v);
  }

  /// x [.., N, in] -> [.., N, hidden]. `states`: what the layers remember, [.., 1, hidden] each (updated);
  /// empty at the start, when they are zeros. `between` changes what each layer but the last gives to the
  /// next (dropout in training).
  template <class Between>
  T operator()(T x, std::vector<T>& states, Between&& between) const {
    using B = Operations<T>;
    for (std::size_t i = 0; i < layers.size(); ++i) {
      if (states.size() <= i) states.push_back(B::zero_rows(x, 1, hidden));
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
