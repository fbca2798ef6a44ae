#include "condition.h"

#include <algorithm>

namespace mien::default_model {
namespace {

// The weakest trained intensity. Below it an emotion fades into neutral.
constexpr float kWeakestLevel = 0.35f;

void add_key(const DirectionKey& key, float weight, std::span<float> style, std::span<float> emotion) {
  style[key.style < 0 ? style.size() - 1 : static_cast<std::size_t>(key.style)] += weight;
  float sum = 0;
  for (std::size_t e = 1; e < key.intensities.size(); ++e) {
    emotion[e] += weight * key.intensities[e];
    sum += key.intensities[e];
  }
  emotion[0] += weight * std::max(0.0f, 1 - sum / kWeakestLevel);
}

}  // namespace

ConditionInput<Tensor> condition_input(const Direction& direction, std::span<const double> seconds,
                                       std::span<const float, kNumLatents> latents) {
  const std::size_t count = direction.is_constant() ? 1 : seconds.size();
  const auto rows = static_cast<std::int64_t>(count);
  ConditionInput<Tensor> in{Tensor({rows, kStyleEntries}), Tensor({rows, kEmotionEntries}),
                            Tensor({rows, kNumLatents})};
  for (std::int64_t i = 0; i < rows; ++i) {
    const auto [first, second, weight] =
        direction.at(direction.is_constant() ? 0 : seconds[static_cast<std::size_t>(i)]);
    add_key(*first, 1 - weight, in.style.row(i), in.emotion.row(i));
    if (weight > 0) add_key(*second, weight, in.style.row(i), in.emotion.row(i));
    std::copy(latents.begin(), latents.end(), in.latents.row(i).begin());
  }
  return in;
}

}  // namespace mien::default_model
