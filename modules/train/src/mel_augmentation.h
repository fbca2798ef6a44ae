#pragma once
#include <cstdint>
#include <span>

#include "mien/base/random.h"

namespace mien::train {

/// Worsens a crop of log-mel frames at random, each time in another way (docs/default_model.md, section 5): a
/// warp of the frequency axis (another vocal tract), an offset per band, reverberation, steady or wavering
/// noise, a common level offset, and masked bands and times. The prepared set holds worsened copies of the
/// sound itself; this adds kinds of rooms and noise without end.
/// @param mel  [M, 64] ln power relative to the running level (loud speech is near 0), changed in place
void augment_mel(std::span<float> mel, double level_offset_sd_db, Rng& rng);

/// Late reverberation, as energies: each band rings on with the time constant of rt60.
/// @param tail_ratio  energy of the tail / energy of the direct sound
void add_reverberation(std::span<float> mel, double rt60_s, double tail_ratio);

/// Noise with a smooth random spectrum, its power `snr_db` below the power of the loud frames. As white noise
/// covers the weak upper bands, the frames' level rises; the crop is set back to the level it had, as the
/// running level would do.
void add_noise(std::span<float> mel, double snr_db, Rng& rng);

}  // namespace mien::train
