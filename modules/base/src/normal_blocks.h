#pragma once
#include <cstdint>

namespace mien {

inline constexpr int kNormalBlocks = 16;

/// Standard normal values of Philox blocks first_block ... first_block + kNormalBlocks - 1 under the counter
/// (block, block >> 32, step, stream): four for each, by Box and Muller in double. No function of the C
/// library takes part, so the bits are those of IEEE arithmetic on every platform.
/// @param key  [2];  out  [4 * kNormalBlocks]
void normal_blocks(std::uint64_t first_block, std::uint32_t step, std::uint32_t stream,
                   const std::uint32_t* key, float* out);

}  // namespace mien
