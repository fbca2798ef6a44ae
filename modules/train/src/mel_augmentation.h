#pragma once
#include <cstdint>
#include <span>

#include "mien/base/random.h"

namespace mien::train {

/// Worsens a crop of log-mel frames at random, each time in another way (docs/default_model.md, section 5): a
/// warp of the frequency axis (another vocal tract), an offset per band, a common level offset, and masked
/// bands and times. Rooms and noise are in the prepared set, on the sound itself.
/// @param mel  [M, 64] ln power relative to the running level (loud speech is near 0), changed in place
void augment_mel(std::span<float> mel, double level_offset_sd_db, Rng& rng);

}  // namespace mien::train
