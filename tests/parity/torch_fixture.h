#pragma once
#include <torch/torch.h>

#include <string>
#include <vector>

#include "fixture.h"

namespace mien::parity {

/// A recorded tensor in its shape. One that is missing throws: it fails the test that asked.
inline torch::Tensor stored(const Fixture& fixture, const std::string& name) {
  auto values = fixture.file().read_float(name);
  if (!values) throw std::runtime_error(values.error().message());
  return torch::from_blob(values->data(), fixture.file().find(name)->shape, torch::kFloat).clone();
}

inline std::vector<double> values_of(const torch::Tensor& x) {
  const torch::Tensor flat = x.detach().to(torch::kDouble).contiguous();
  return {flat.data_ptr<double>(), flat.data_ptr<double>() + flat.numel()};
}
inline std::vector<double> values_of(const mien::Tensor& x) { return {x.values().begin(), x.values().end()}; }

/// How far `got` is from `want`, as a part of the size of the whole tensor: entries of a gradient differ by
/// orders of magnitude.
inline double relative_distance(const torch::Tensor& got, const torch::Tensor& want) {
  return (got - want).norm().item<double>() / want.norm().item<double>();
}

}  // namespace mien::parity
