#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "head/head_skin.h"

namespace mien::head {

/// Skin vertices of the 68 landmarks in iBUG order: jaw line from the character's right to its left (0-16),
/// brows (17-26), nose (27-35), eyes (36-47), outline of the lips (48-59), contact line (60-67).
std::vector<std::uint32_t> landmarks68(const HeadSkin& skin);

/// Vertices of the lips: mouth rings 1 ... 6. Ascending.
std::vector<std::uint32_t> lip_region(const HeadSkin& skin);
/// Vertices of lids, brows, forehead and temples. Ascending.
std::vector<std::uint32_t> upper_face_region(const HeadSkin& skin);

/// "mouth0" ... "mouth14" (48 vertices each), "eyeLeft0" ... "eyeRight8" (28 each), in ring order.
std::map<std::string, std::vector<std::uint32_t>> named_rings(const HeadSkin& skin);

}  // namespace mien::head
