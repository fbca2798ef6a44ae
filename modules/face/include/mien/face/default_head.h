#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "mien/core/character.h"

namespace mien {

/// Mien's own head with the names that let tests, retargeting and hit testing do without bare vertex numbers.
struct DefaultHead {
  /// Parts: "skin" (shapes: all 52 ARKit names in their order, some without vertices), then "eyes" (left and
  /// right eyeball, the tissue in the eyes' corners), "teeth" (upper, then lower), "tongue", "brows",
  /// "lashes", "ears" and "hair", each with only the shapes that move it. Normals, normal offsets and linear
  /// vertex colours are filled. Regions of the skin: "lips" (288 vertices), "upper_face" (1763),
  /// "landmarks68" (iBUG order).
  Character character;
  /// [V of the skin] the vertex on the other side of the face; vertices of the middle line map to themselves.
  std::vector<std::uint32_t> mirror;
  /// Named skin vertices: "noseTip", "chin", "browMidL", "cheekLowR" ...
  std::map<std::string, std::uint32_t> handles;
  /// Loops of skin vertices. "mouth0" ... "mouth14" (48 vertices: right corner, upper lip, left corner at 24,
  /// lower lip): 0 the outline, 5 the contact line, 8 and up the cavity. "eyeLeft0" ... "eyeRight8" (28
  /// vertices: inner corner, upper lid, outer corner at 14, lower lid): 6 is the lid edge.
  std::map<std::string, std::vector<std::uint32_t>> rings;
};

/// Builds the head by code alone: the same bytes for any number of threads. Metres; the origin lies midway
/// between the ears. Takes about a second.
DefaultHead build_default_head(int num_threads = 1);

/// build_default_head(num_threads).character.
Character default_head(int num_threads = 1);

}  // namespace mien
