#pragma once
#include <cstdint>
#include <vector>

#include "mien/nn/layers.h"

namespace mien {

/// What causal layers remember of the past, in the order in which they run. Empty at the start of a
/// recording, when the past is taken as zeros; after each call it holds the last inputs of every layer, so
/// that feeding a recording in any pieces gives what feeding it whole gives.
template <class T>
class CausalState {
 public:
  /// Start of a pass through the network.
  void rewind() { next_ = 0; }
  /// The slot of the layer that runs now; nothing in it yet at the start of a recording.
  T* slot() {
    if (next_ == past_.size()) past_.emplace_back();
    is_new_ = next_ >= num_filled_;
    if (is_new_) num_filled_ = next_ + 1;
    return &past_[next_++];
  }
  [[nodiscard]] bool slot_is_new() const { return is_new_; }

 private:
  std::vector<T> past_;
  std::size_t next_ = 0, num_filled_ = 0;
  bool is_new_ = true;
};

/// A convolution over time that sees only the present and the past: output n depends on inputs n - (kernel-1)
/// dilation
/// ... n. Weight columns are ordered by tap, oldest first.
template <class T>
struct CausalConv {
  std::int64_t in = 0, out = 0, kernel = 1, dilation = 1;
  Linear<T> taps{kernel * in, out};

  template <class V>
  void visit(V& v) {
    taps.visit(v);
  }

  /// x [.., N, in] -> [.., N, out]. Without a state the past is zeros.
  T operator()(const T& x, CausalState<T>* state) const {
    using B = Operations<T>;
    const std::int64_t reach = (kernel - 1) * dilation;
    T* past = state ? state->slot() : nullptr;
    const bool fresh = past == nullptr || state->slot_is_new();
    const T whole = B::concat_rows({fresh ? B::zero_rows(x, reach, in) : *past, x});
    if (past) *past = B::rows(whole, B::num_rows(whole) - reach, reach);
    return taps(B::unfold(whole, kernel, dilation));
  }
};

/// y = x + W2 gelu(conv(norm(x) scaled and shifted)); W2 starts at zero, so that a new block changes nothing.
template <class T>
struct CausalBlock {
  std::int64_t width = 0, dilation = 1;
  LayerNorm<T> norm{width};
  CausalConv<T> conv{width, width, 3, dilation};
  Linear<T> mix{width, width, Init::zero};

  template <class V>
  void visit(V& v) {
    v.scope("norm", norm);
    v.scope("conv", conv);
    v.scope("mix", mix);
  }

  /// `modulation`: nothing, or [.., N or 1, 2 width] = scale - 1 and shift of the normalised input (FiLM).
  T operator()(const T& x, CausalState<T>* state, const T* modulation = nullptr) const {
    using B = Operations<T>;
    T h = norm(x);
    if (modulation)
      h = B::add(B::mul(h, B::add_one(B::columns(*modulation, 0, width))),
                 B::columns(*modulation, width, width));
    return B::add(x, mix(B::gelu(conv(h, state))));
  }
};

}  // namespace mien
