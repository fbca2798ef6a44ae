#pragma once
#include <cstdint>
#include <string_view>
#include <vector>

#include "mien/base/result.h"

namespace mien {

/// Vertices that a measure looks at.
struct VertexRegions {
  std::vector<std::uint32_t> mouth;  ///< for LVE
  std::vector<std::uint32_t> upper;  ///< for FDD
};

/// Thresholds of the authors' script for Multiface, whose regions are weights.
inline constexpr double kMouthWeightAbove = 0.1, kUpperWeightAbove = 0.4;

/// Vertices of a region file of the data sets (FaceDiffuser specification, section 13), in the file's order.
/// Either indices, separated by commas, spaces or newlines; or one weight for each of the V vertices, at
/// least one of them written with a dot: then the vertices whose weight is above `weight_above`. Errors
/// (Errc::input): something that is no number; (Errc::incompatible): an index that is not below V.
Result<std::vector<std::uint32_t>> read_region(std::string_view text, std::int64_t num_vertices,
                                               double weight_above);

}  // namespace mien
