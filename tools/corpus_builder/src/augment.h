#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "mien/base/random.h"

namespace mien {

enum class NoiseKind { white, brown, babble };

struct Reverb {
  double rt60_s = 0.3;      ///< time to fall by 60 dB
  double tail_ratio = 0.2;  ///< energy of the tail relative to the direct sound
};
struct Coloration {
  bool is_high = false;  ///< add the high-passed sound, else the low-passed
  double hz = 1000;
  double gain = 0.5;
};
struct Band {
  double low_hz = 100;
  double high_hz = 6000;
};
struct AddedNoise {
  NoiseKind kind = NoiseKind::white;
  double pole = 0.9;   ///< brown: one-pole smoothing
  int voices = 3;      ///< babble: how many other clips are mixed
  double snr_db = 20;  ///< against the active RMS of the sound at this point
};

/// One way of worsening a recording (spec section 10), in the order of the fields. Pure data: the same recipe
/// and sound give the same samples.
struct AugmentRecipe {
  double time_factor = 1.0;  ///< durations are multiplied by this, pitch divided
  std::optional<Reverb> reverb;
  std::optional<Coloration> coloration;
  std::optional<Band> band;
  std::optional<AddedNoise> noise;
  std::optional<double> clip_level;
  bool mu_law = false;
  double gain_db = 0.0;
  std::uint64_t seed = 0;  ///< of the noise samples and the reverberation tail
};

/// A recipe for training: with probability 0.85 the full list of section 10, else only faint noise and a
/// gain, because sound straight from a synthesiser (exact zeros before stops) must never be trained on.
AugmentRecipe draw_training_recipe(Rng& rng);

/// Short recordings that babble noise is mixed from, 16 kHz.
using BabblePool = std::vector<std::vector<float>>;

/// The sound after the recipe: round(S * time_factor) samples at 16 kHz. Loudness is brought to active RMS
/// 0.06 between the speed change and the rest. An empty pool turns babble into brown noise.
std::vector<float> augment(std::span<const float> samples_16k, const AugmentRecipe& recipe,
                           const BabblePool& pool);

/// Noise of unit RMS.
std::vector<float> make_noise(const AddedNoise& noise, std::size_t count, const BabblePool& pool, Rng& rng);

}  // namespace mien
