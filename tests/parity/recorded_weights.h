#pragma once
#include <stdexcept>
#include <string>
#include <string_view>

#include "fixture.h"
#include "mien/nn/parameters.h"
#include "mien/nn/runtime_operations.h"

namespace mien::parity {

/// How a suite that is written once reaches a tensor library; the runtime's is below, LibTorch's with its
/// tests:
///   T given(const mien::Tensor&)                     recorded values [N, D] as the networks of T read them
///   mien::Tensor values(const T&)                    and back, [N, D]
///   T parameter(const mien::Tensor&)                 of the recorded shape
///   Operations<T>::Matrix matrix(const mien::Tensor&)       weights [out, in]
///   Operations<T>::Matrix convolution(const mien::Tensor&)  weights [out, in, kernel]
template <class T>
struct Library;

/// Fills a network with recorded weights, which lie in one file with recorded values.
template <class T>
class FillRecorded : public ParameterVisitor<FillRecorded<T>> {
 public:
  explicit FillRecorded(const Fixture& weights, std::string prefix = "")
      : weights_(weights), prefix_(std::move(prefix)) {}
  void matrix(std::string_view name, typename Operations<T>::Matrix& slot, std::int64_t out, std::int64_t in,
              Init) {
    slot = Library<T>::matrix(stored(name, {out, in}));
  }
  void convolution(std::string_view name, typename Operations<T>::Matrix& slot, std::int64_t out,
                   std::int64_t in, std::int64_t kernel, Init) {
    slot = Library<T>::convolution(stored(name, {out, in, kernel}));
  }
  void tensor(std::string_view name, T& slot, const Shape& shape, Init) {
    slot = Library<T>::parameter(stored(name, shape));
  }

 private:
  mien::Tensor stored(std::string_view name, const Shape& shape) const {
    const std::string full = prefix_ + this->full_name(name);
    const auto found = weights_.file().expect(full, shape);
    if (!found) throw std::runtime_error(found.error().message());
    return mien::Tensor(shape, weights_.file().read_float(full).value());
  }
  const Fixture& weights_;
  std::string prefix_;
};

template <class T, class Network>
Network recorded_network(const Fixture& weights, Network network, const std::string& prefix = "") {
  FillRecorded<T> fill(weights, prefix);
  network.visit(fill);
  return network;
}

template <>
struct Library<Tensor> {
  static Tensor given(const Tensor& x) { return x; }
  static Tensor values(const Tensor& x) { return x; }
  static Tensor parameter(const Tensor& x) { return x; }
  static PackedMatrix matrix(const Tensor& x) { return PackedMatrix(x); }
  static PackedMatrix convolution(const Tensor& x) { return PackedMatrix(tap_major(x)); }
};

}  // namespace mien::parity
