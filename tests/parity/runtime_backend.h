#pragma once
#include "backend.h"
#include "mien/models/runtime_parameters.h"

namespace mien::parity {

template <>
struct Backend<Tensor> {
  static Tensor given(const Tensor& x) { return x; }
  static Tensor values(const Tensor& x) { return x; }
  static Tensor parameter(const Tensor& x) { return x; }
  static PackedMatrix matrix(const Tensor& x) { return PackedMatrix(x); }
  static PackedMatrix convolution(const Tensor& x) { return PackedMatrix(tap_major(x)); }
  template <class Network>
  static Network load(const Fixture& weights, Network network, const std::string& prefix = "") {
    LoadRuntime load(weights.file(), prefix);
    if (prefix.empty()) load.leave_out("audio_encoder.");  // has a prefix of its own
    network.visit(load);
    const Status status = load.finish();
    if (!status) throw std::runtime_error(status.error().message());
    return network;
  }
};

}  // namespace mien::parity
