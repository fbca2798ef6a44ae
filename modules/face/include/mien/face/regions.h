#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "mien/base/result.h"
#include "mien/core/character.h"

namespace mien {

/// Names of the vertex lists in Character::regions.
inline constexpr std::string_view kLipsRegion = "lips";
inline constexpr std::string_view kUpperFaceRegion = "upper_face";
inline constexpr std::string_view kLandmarksRegion = "landmarks68";

/// Positions in "landmarks68" of the middle of the upper and lower lip's contact line.
inline constexpr std::size_t kUpperLipLandmark = 62, kLowerLipLandmark = 66;

/// Vertices of parts[0] in a region. Errors (Errc::incompatible): the character lacks the region, or the
/// region names a vertex that parts[0] does not have.
Result<std::span<const std::uint32_t>> find_region(const Character& character, std::string_view name);

/// Distance between landmarks 62 and 66, metres: how far the lips are parted.
///
/// @param skin_positions  [V of parts[0]] posed, metres
/// Errors as find_region; also when "landmarks68" has not 68 entries.
Result<float> lip_gap(const Character& character, std::span<const Vec3> skin_positions);

}  // namespace mien
