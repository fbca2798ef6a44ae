#pragma once
#include <array>
#include <cstdint>
#include <span>

#include "mien/models/default/network.h"

namespace mien::default_model {

/// A chunk of the diffused numbers is coded as the DCT over time of its difference from the last sample
/// before it, each coefficient divided by its own standard deviation (docs/default_model.md, section 4).
/// Samples are [6, U] row-major, coefficients [6 frequencies, U] row-major.
///
/// The orthonormal DCT-II of 6 samples: matrix[frequency][sample].
using DctMatrix = std::array<std::array<float, kChunkSamples>, kChunkSamples>;
const DctMatrix& dct_matrix();

/// samples, last [U] (the sample before the chunk) -> coefficients, not yet divided by their sd.
void encode_chunk(std::span<const float> samples, std::span<const float> last, std::span<float> coefficients);
/// The inverse.
void decode_chunk(std::span<const float> coefficients, std::span<const float> last, std::span<float> samples);

}  // namespace mien::default_model
