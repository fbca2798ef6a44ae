#pragma once
#include <optional>
#include <string>
#include <vector>

#include "gltf_document.h"
#include "mien/core/character.h"
#include "read_budget.h"
#include "transform.h"

namespace mien::io {

/// Where the vertices of a mesh go.
struct MeshPlacement {
  Matrix world = kIdentity;    ///< of the node; not used by skinned meshes
  std::vector<Matrix> joints;  ///< joint world * inverse bind, one per joint; empty: not skinned
};

/// What to make of a mesh's morph targets.
struct ShapePlan {
  struct Shape {
    std::string name;
    std::vector<std::size_t> targets;  ///< added up
  };
  std::vector<Shape> shapes;
  std::vector<float> baked;  ///< [targets] weight that is added to the neutral
};

/// One primitive as a part without name; nothing when it is points or lines.
Result<std::optional<CharacterPart>> read_primitive(const GltfDocument& document, const Json& primitive,
                                                    const ShapePlan& plan, const MeshPlacement& placement,
                                                    ReadBudget& budget);

}  // namespace mien::io
