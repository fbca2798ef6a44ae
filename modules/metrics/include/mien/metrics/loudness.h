#pragma once
#include <cstdint>
#include <span>
#include <vector>

namespace mien {

/// Level of speech at the instants n / 60 s in dB: 10 log10 of the Hann-weighted mean square of 25 ms around
/// the instant
/// (+ 1e-7), with zeros outside the recording; floored at its 95th percentile - 35 dB and smoothed with a
/// Gaussian of sigma 30 ms, 13 taps (human benchmark README, "Jaw-energy correlation").
///
/// @param samples_16k  [S] mono, 16 kHz
/// @return             [round(60 S / 16000)]
std::vector<double> speech_level_db(std::span<const float> samples_16k);

/// Loudness E = clamp((level - its 95th percentile + 30 dB) / 30 dB, 0, 1).
std::vector<double> loudness(std::span<const double> level_db);

/// The Gaussian of the jaw-energy measure: sigma 30 ms and 13 taps at 60 frames/s.
std::vector<double> smooth_30_ms(std::span<const double> values);

}  // namespace mien
