#pragma once
#include <cstdint>

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
