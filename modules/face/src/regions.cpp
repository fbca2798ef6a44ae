#include "mien/face/regions.h"

#include <algorithm>

namespace mien {
namespace {

constexpr std::size_t kNumLandmarks = 68;

Error unfit(const Character& character, std::string why, std::string fix) {
  return {Errc::incompatible, "character '" + character.name + "'", std::move(why), std::move(fix)};
}

std::string known_regions(const Character& character) {
  if (character.regions.empty()) return "it has none; use the default head, or a character with regions";
  std::string names;
  for (const auto& [name, vertices] : character.regions) names += (names.empty() ? "" : ", ") + name;
  return "it has: " + names;
}

}  // namespace

Result<std::span<const std::uint32_t>> find_region(const Character& character, std::string_view name) {
  const auto found = character.regions.find(std::string(name));
  if (found == character.regions.end())
    return unfit(character, "no region '" + std::string(name) + "'", known_regions(character));
  const std::size_t num_vertices =
      character.parts.empty() ? 0 : character.parts.front().mesh.positions.size();
  const auto& vertices = found->second;
  const auto largest = std::max_element(vertices.begin(), vertices.end());
  if (largest != vertices.end() && *largest >= num_vertices)
    return unfit(character,
                 "region '" + std::string(name) + "' names vertex " + std::to_string(*largest) + " of " +
                     std::to_string(num_vertices),
                 "the region belongs to another mesh");
  return std::span<const std::uint32_t>(vertices);
}

Result<float> lip_gap(const Character& character, std::span<const Vec3> skin_positions) {
  MIEN_TRY(const auto landmarks, find_region(character, kLandmarksRegion));
  if (landmarks.size() != kNumLandmarks)
    return unfit(character, "'landmarks68' has " + std::to_string(landmarks.size()) + " entries, expected 68",
                 "");
  contract(skin_positions.size() == character.parts.front().mesh.positions.size(),
           "lip_gap: one position per skin vertex expected");
  return length(skin_positions[landmarks[kUpperLipLandmark]] - skin_positions[landmarks[kLowerLipLandmark]]);
}

}  // namespace mien
