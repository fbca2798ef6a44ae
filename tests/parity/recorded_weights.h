#pragma once
#include <stdexcept>
#include <string>
#include <string_view>

#include "backend.h"
#include "mien/nn/parameters.h"

namespace mien::parity {

/// Fills a network with recorded weights that lie in one file with recorded values.
template <class T>
class FillRecorded : public ParameterVisitor<FillRecorded<T>> {
 public:
  explicit FillRecorded(const Fixture& weights, std::string prefix = "")
      : weights_(weights), prefix_(std::move(prefix)) {}
  void matrix(std::string_view name, typename Operations<T>::Matrix& slot, std::int64_t out, std::int64_t in,
              Init) {
    slot = Backend<T>::matrix(stored(name, {out, in}));
  }
  void convolution(std::string_view name, typename Operations<T>::Matrix& slot, std::int64_t out,
                   std::int64_t in, std::int64_t kernel, Init) {
    slot = Backend<T>::convolution(stored(name, {out, in, kernel}));
  }
  void tensor(std::string_view name, T& slot, const Shape& shape, Init) {
    slot = Backend<T>::parameter(stored(name, shape));
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

}  // namespace mien::parity
