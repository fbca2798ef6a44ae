#pragma once
#include <vector>

#include "mien/base/random.h"
#include "mien/train/default_model.h"

namespace mien::train {

/// Collects the condition of a batch of (take, entry) as [B, 1, ..] tensors; style and emotion are each
/// hidden
/// ("unknown") with `unknown_probability`, which 0 switches off.
class ConditionBatch {
 public:
  ConditionBatch(const TrainingSet& set, double unknown_probability)
      : set_(set), hide_(unknown_probability) {}

  void add(std::int64_t take, std::size_t entry, Rng& rng) {
    using namespace default_model;
    std::vector<float> style(kStyleEntries), emotion(kEmotionEntries);
    style[rng.chance(hide_) ? kStyleEntries - 1 : set_.style(take, entry)] = 1;
    const auto& e = set_.entries()[entry];
    if (rng.chance(hide_))
      emotion[kEmotionEntries - 1] = 1;
    else
      emotion[e.emotion] = e.emotion == 0 ? 1.0f : e.intensity;
    styles_.insert(styles_.end(), style.begin(), style.end());
    emotions_.insert(emotions_.end(), emotion.begin(), emotion.end());
    const auto z = set_.latents(take, entry);
    latents_.insert(latents_.end(), z.begin(), z.end());
  }

  [[nodiscard]] default_model::ConditionInput<torch::Tensor> tensors(torch::Device device) {
    const auto make = [&](std::vector<float>& v, std::int64_t width) {
      const auto batch = static_cast<std::int64_t>(v.size()) / width;
      return torch::from_blob(v.data(), {batch, 1, width}).clone().to(device);
    };
    return {make(styles_, default_model::kStyleEntries), make(emotions_, default_model::kEmotionEntries),
            make(latents_, default_model::kNumLatents)};
  }

 private:
  const TrainingSet& set_;
  double hide_;
  std::vector<float> styles_, emotions_, latents_;
};

/// [B, 100 Hz frames, W] -> [B, num_frames, W] at 60 fps: frame n is the position 100 n / 60 + shift of x.
torch::Tensor interpolate_to_motion_rate(const torch::Tensor& x, std::int64_t num_frames, std::int64_t shift);

}  // namespace mien::train
