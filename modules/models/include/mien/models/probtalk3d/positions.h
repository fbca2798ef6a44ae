#pragma once
#include <cstdint>
#include <vector>

namespace mien::probtalk3d {

/// Frames that the positional table of the published programs has; a longer clip has no positions.
inline constexpr std::int64_t kMostFrames = 5000;

/// Rows [num_frames, width] of sinusoids: sin(t w_i) and cos(t w_i) in turn, w_i = exp(2 i (-ln 10000 /
/// width)). Every operation is float32, as in the original, whose checkpoints hold this table: rounding of
/// the product counts for late frames.
std::vector<float> position_table(std::int64_t num_frames, std::int64_t width);

}  // namespace mien::probtalk3d
