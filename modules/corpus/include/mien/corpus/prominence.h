#pragma once
#include <span>
#include <vector>

#include "mien/corpus/performance.h"

namespace mien {

/// Fundamental frequency (Hz) at instants spaced 10 ms; 0 = unvoiced. Autocorrelation of 80 ms windows,
/// 65-400 Hz, voiced when the normalised peak is above 0.45 (specification, section 4.4). Frame t is centred
/// on 0.01 t seconds.
/// @param samples_16k  mono, 16 kHz; any level
/// @return one value for each 160 samples, plus one
std::vector<float> track_pitch(std::span<const float> samples_16k);

/// Sets the prominence of all vowels from their level, and the accents from level, pitch and duration
/// (section 4.4). Nothing else of the utterance changes. Phones outside of the sound keep prominence 1.
/// @param samples_16k  the utterance's sound, mono, 16 kHz, finite; any level
void add_prominence(Utterance& utterance, std::span<const float> samples_16k);

}  // namespace mien
