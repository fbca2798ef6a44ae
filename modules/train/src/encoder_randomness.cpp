#include "mien/train/encoder_randomness.h"

#include <algorithm>
#include <numeric>

namespace mien::train {

std::vector<std::uint8_t> draw_masked_frames(const EncoderConfig& config, std::int64_t num_frames, Rng& rng) {
  const std::int64_t length = config.mask_time_length;
  if (!config.apply_spec_augment || config.mask_time_prob <= 0 || length < 1 || num_frames < length)
    return {};
  const double expected =
      config.mask_time_prob * static_cast<double>(num_frames) / static_cast<double>(length);
  auto num_spans = static_cast<std::int64_t>(expected + rng.uniform());
  num_spans = std::max(num_spans, config.mask_time_min_masks);
  num_spans = std::min(num_spans, num_frames / length);

  // The first places of a shuffle: distinct starts, all sets alike.
  std::vector<std::int64_t> starts(static_cast<std::size_t>(num_frames - length + 1));
  std::iota(starts.begin(), starts.end(), 0);
  std::vector<std::uint8_t> masked(static_cast<std::size_t>(num_frames), 0);
  for (std::size_t i = 0; i < static_cast<std::size_t>(num_spans); ++i) {
    std::swap(starts[i], starts[i + rng.below(starts.size() - i)]);
    std::fill_n(masked.begin() + starts[i], length, std::uint8_t{1});
  }
  return masked;
}

std::vector<std::uint8_t> draw_skipped_layers(const EncoderConfig& config, Rng& rng) {
  if (config.layerdrop <= 0) return {};
  std::vector<std::uint8_t> skipped(static_cast<std::size_t>(config.num_hidden_layers));
  for (auto& flag : skipped) flag = rng.chance(config.layerdrop) ? 1 : 0;
  return skipped;
}

}  // namespace mien::train
