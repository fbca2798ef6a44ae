#pragma once
#include <cstdint>
#include <vector>

#include "mien/base/random.h"
#include "mien/models/speech_encoder/encoder_config.h"

// What fine-tuning does at random inside a speech encoder, beside dropout. The published programs differ in
// their generators; the distributions are theirs.
namespace mien::train {

/// SpecAugment in time (Park et al. 2019): which of T projected frames are replaced by the trained vector
/// masked_spec_embed, 1 = replaced. floor(prob T / length + u) spans with u uniform in [0, 1), at least
/// mask_time_min_masks, at most T / length; starts are distinct and uniform, spans may overlap. Empty when
/// nothing is masked: a probability of 0, or fewer frames than a span.
std::vector<std::uint8_t> draw_masked_frames(const EncoderConfig& config, std::int64_t num_frames, Rng& rng);

/// LayerDrop (Fan et al. 2020): each layer is left out with probability `layerdrop`, 1 = left out. Empty for
/// a probability of 0.
std::vector<std::uint8_t> draw_skipped_layers(const EncoderConfig& config, Rng& rng);

}  // namespace mien::train
