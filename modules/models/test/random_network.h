#pragma once
#include <algorithm>
#include <cmath>

#include "mien/base/hash.h"
#include "mien/base/random.h"
#include "mien/nn/parameters.h"
#include "mien/nn/runtime_operations.h"

namespace mien {

/// Fills a runtime network with reproducible random weights of a size that keeps values near one.
class RandomWeights : public ParameterVisitor<RandomWeights> {
 public:
  explicit RandomWeights(std::uint64_t seed) : seed_(seed) {}
  void matrix(std::string_view name, PackedMatrix& slot, std::int64_t out, std::int64_t in, Init) {
    slot = PackedMatrix(weights(name, {out, in}, in));
  }
  void convolution(std::string_view name, PackedMatrix& slot, std::int64_t out, std::int64_t in,
                   std::int64_t kernel, Init) {
    slot = PackedMatrix(tap_major(weights(name, {out, in, kernel}, in * kernel)));
  }
  /// The same values for a network over PlainWeights.
  void matrix(std::string_view name, Tensor& slot, std::int64_t out, std::int64_t in, Init) {
    slot = weights(name, {out, in}, in);
  }
  void convolution(std::string_view name, Tensor& slot, std::int64_t out, std::int64_t in,
                   std::int64_t kernel, Init) {
    slot = weights(name, {out, in, kernel}, in * kernel);
  }
  void convolution(std::string_view name, PackedMatrix& slot, std::int64_t out, std::int64_t in,
                   std::int64_t kernel, Init) {
    Tensor w = normal(name, {out, in, kernel});
    const float size = 1.5f / std::sqrt(static_cast<float>(std::max<std::int64_t>(in * kernel, 1)));
    slot = PackedMatrix(tap_major(scale(std::move(w), size)));
  }
  void tensor(std::string_view name, Tensor& slot, const Shape& shape, Init init) {
    slot = normal(name, shape);
    for (float& v : slot.values()) v = 0.3f * v + (init == Init::one ? 1.0f : 0.0f);
  }
  void buffer(std::string_view name, Tensor& slot, const Shape& shape) {
    tensor(name, slot, shape, Init::zero);
  }

 private:
  Tensor weights(std::string_view name, const Shape& shape, std::int64_t inputs) {
    Tensor w = normal(name, shape);
    const float size = 1.5f / std::sqrt(static_cast<float>(std::max<std::int64_t>(inputs, 1)));
    for (float& v : w.values()) v *= size;
    return w;
  }
  Tensor normal(std::string_view name, const Shape& shape) {
    Tensor t(shape);
    NoiseField(hash64(full_name(name), seed_), 0).normal(0, 0, t.values());
    return t;
  }
  std::uint64_t seed_;
};

template <class Network>
Network random_network(Network network, std::uint64_t seed = 1) {
  RandomWeights fill(seed);
  network.visit(fill);
  return network;
}

inline Tensor random_rows(std::int64_t num_rows, std::int64_t width, std::uint64_t seed) {
  Tensor t({num_rows, width});
  NoiseField(seed, 7).normal(0, 0, t.values());
  return t;
}

}  // namespace mien
