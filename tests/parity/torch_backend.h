#pragma once
#include <torch/torch.h>

#include <set>

#include "backend.h"
#include "mien/train/torch_channel_operations.h"
#include "mien/train/torch_parameters.h"

namespace mien::parity {

template <>
struct Backend<torch::Tensor> {
  using T = torch::Tensor;
  static T given(const mien::Tensor& x) {
    return torch::from_blob(const_cast<float*>(x.data()), {1, x.num_rows(), x.width()}, torch::kFloat)
        .clone();
  }
  static T parameter(const mien::Tensor& x) {
    return torch::from_blob(const_cast<float*>(x.data()), x.shape(), torch::kFloat).clone();
  }
  static T matrix(const mien::Tensor& x) { return parameter(x); }
  static T convolution(const mien::Tensor& x) { return parameter(x); }
  static mien::Tensor values(const T& x) {
    const T rows = x.detach().reshape({-1, x.size(-1)}).contiguous();
    return mien::Tensor({rows.size(0), rows.size(1)},
                        {rows.data_ptr<float>(), static_cast<std::size_t>(rows.numel())});
  }
  template <class Network>
  static Network load(const Fixture& weights, Network network, const std::string& prefix = "") {
    train::Initialise create(1);
    network.visit(create);
    std::set<std::string> names;
    for (const auto& entry : train::parameters(network)) {
      const std::string name = prefix + entry.name;
      if (weights.file().find(name) == nullptr) throw std::runtime_error("no recorded '" + name + "'");
      const mien::Tensor stored = weights.tensor(name);
      if (stored.count() != entry.slot->numel()) throw std::runtime_error("'" + name + "' has another size");
      *entry.slot = given(stored).reshape(entry.slot->sizes());
      names.insert(name);
    }
    for (const auto& stored : weights.file().tensors()) {
      const bool is_ours =
          prefix.empty() ? !stored.name.starts_with("audio_encoder.") : stored.name.starts_with(prefix);
      if (is_ours && !names.contains(stored.name))
        throw std::runtime_error("'" + stored.name + "' is no parameter");
    }
    return network;
  }
};

}  // namespace mien::parity
