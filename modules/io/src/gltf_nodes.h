#pragma once
#include <optional>
#include <vector>

#include "gltf_document.h"
#include "transform.h"

namespace mien::io {

/// The node hierarchy of a document at rest.
struct NodeTree {
  std::vector<std::optional<std::size_t>> parents;
  std::vector<Matrix> world;               ///< node to the space of Character: +z out of the face
  std::vector<Quaternion> world_rotation;  ///< rotation part of `world`
  std::vector<std::size_t>
      in_scene;  ///< nodes of the default scene, parents first; all nodes when there is no scene
};

/// Errors (Errc::input): children that do not exist, a node with two parents, a cycle, numbers that are not
/// finite.
Result<NodeTree> read_nodes(const GltfDocument& document);

/// Placement of a node relative to its parent; nothing when its matrix cannot be taken apart.
std::optional<Placement> node_placement(const Json& node);

/// The node that turns the head, or nothing: a joint named head ("Head", "mixamorig:Head", "J_Bip_C_Head"
/// ...), or such a node that carries every node of `face_nodes`. With several candidates the plainest name
/// wins, then the first.
std::optional<std::size_t> find_head_node(const GltfDocument& document, const NodeTree& tree,
                                          const std::vector<std::size_t>& face_nodes);

}  // namespace mien::io
