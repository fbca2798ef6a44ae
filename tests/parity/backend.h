#pragma once
#include <string>

#include "fixture.h"

namespace mien::parity {

/// How a suite that is written once reaches a tensor library T. A program that runs the suites specialises it
/// for its own library:
///
///   T given(const mien::Tensor& x)         recorded values [N, D] as the networks of T read them
///   mien::Tensor values(const T& x)        and back, [N, D], to compare
///   Network load(weights, network, prefix) fills a network from the recorded tensors whose names begin with
///                                          the prefix; throws when one is missing or left over
///   T parameter(const mien::Tensor& x)     recorded weights, of any shape
///   Matrix matrix(const mien::Tensor& x)   Operations<T>::Matrix of weights [out, in]
///   Matrix convolution(const mien::Tensor& x)  and of a convolution's [out, in, kernel]
template <class T>
struct Backend;

}  // namespace mien::parity
