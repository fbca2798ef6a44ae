#pragma once
#include "mien/nn/channel_operations.h"
#include "mien/nn/parameters.h"

namespace mien {

/// Normalises each channel with the mean and variance that training measured, then y = gamma x + beta (Ioffe
/// and Szegedy 2015). PyTorch's names; its counter num_batches_tracked changes nothing here and has no slot.
template <class T>
struct BatchNorm {
  std::int64_t width = 0;
  double eps = 1e-5;
  T gamma{}, beta{}, mean{}, variance{};

  template <class V>
  void visit(V& v) {
    v.tensor("weight", gamma, Shape{width}, Init::one);
    v.tensor("bias", beta, Shape{width}, Init::zero);
    v.buffer("running_mean", mean, Shape{width});
    v.buffer("running_var", variance, Shape{width});
  }
};

/// How batch norms work when a network runs. Training passes another object with the same operator, which
/// normalises with the statistics of the batch and updates those of the layer.
template <class T>
struct MeasuredStatistics {
  /// x [.., N, width], any number of rows
  T operator()(const BatchNorm<T>& norm, T x) const {
    return ChannelOperations<T>::batch_norm(std::move(x), norm.gamma, norm.beta, norm.mean, norm.variance,
                                            norm.eps);
  }
};

}  // namespace mien
