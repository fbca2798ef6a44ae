#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "mien/core/blendshape_rig.h"
#include "mien/core/mesh.h"

namespace mien {

/// One mesh of a character with the shapes that move it. Shape names are ARKit's where the source's could be matched.
struct CharacterPart {
  std::string name;  ///< e.g. "skin", "eyes", "teeth", "hair"
  Mesh mesh;
  std::vector<Blendshape> shapes;  ///< empty for parts that only follow the head
};

/// A head that can be animated: parts in one common space, metres.
struct Character {
  std::string name;
  std::vector<CharacterPart> parts;
  /// Named vertex lists of parts[0] (the skin): "lips", "upper_face", "landmarks68" (iBUG order). May be empty.
  std::map<std::string, std::vector<std::uint32_t>> regions;
};

}  // namespace mien
