#pragma once
#include <cstddef>
#include <span>
#include <vector>

namespace mien {

// Small filters on mono sound at 16 kHz; all work in double and return as many samples as they get unless
// said.

/// RMS over the samples with |x| > 0.003: the level of the speech without its pauses (spec section 10). 0 if
/// none.
double active_rms(std::span<const float> x);
/// Scales so that active_rms is 0.06; leaves sound without active samples alone.
void normalise_loudness(std::span<float> x);

/// First-order low pass, -3 dB at `hz`.
std::vector<float> low_pass(std::span<const float> x, double hz);
/// First-order shelf: unity below `hz`, `gain_db` above.
void high_shelf(std::span<float> x, double hz, double gain_db);
/// Fourth-order Butterworth high pass at `low_hz` followed by a fourth-order Butterworth low pass at
/// `high_hz`.
void band_limit(std::span<float> x, double low_hz, double high_hz);

/// x convolved with `kernel`, cut to the length of x.
std::vector<float> convolve(std::span<const float> x, std::span<const float> kernel);

/// Band-limited conversion to another rate; round(S * to / from) samples.
std::vector<float> resample_audio(std::span<const float> x, double from_hz, double to_hz);

/// Frequency tremor: time runs at 1 + depth sin(2 pi hz t). Moves no sound by more than depth / (2 pi hz)
/// seconds.
std::vector<float> tremor(std::span<const float> x, double hz, double depth);

}  // namespace mien
