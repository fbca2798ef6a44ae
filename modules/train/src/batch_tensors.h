#pragma once
#include <torch/torch.h>

#include <cstdint>
#include <vector>

#include "mien/base/random.h"

namespace mien::train {

/// A copy of values as a tensor of that shape.
inline torch::Tensor as_tensor(const std::vector<float>& values, const std::vector<std::int64_t>& shape) {
  return torch::from_blob(const_cast<float*>(values.data()), shape, torch::kFloat).clone();
}

/// Standard normal noise that follows from the seed alone.
inline torch::Tensor noise_tensor(std::uint64_t seed, const std::vector<std::int64_t>& shape) {
  torch::Tensor noise = torch::empty(shape);
  NoiseField(seed, 1).normal(0, 0, {noise.data_ptr<float>(), static_cast<std::size_t>(noise.numel())});
  return noise;
}

/// [B, W, K] -> [B, W - 1, K]: from frame to frame.
inline torch::Tensor frame_differences(const torch::Tensor& x) {
  return x.narrow(1, 1, x.size(1) - 1) - x.narrow(1, 0, x.size(1) - 1);
}

}  // namespace mien::train
