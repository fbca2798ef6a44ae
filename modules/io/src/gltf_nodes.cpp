#include "gltf_nodes.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "gltf_component_type.h"

namespace mien::io {
namespace {

Error bad_node(std::size_t node, std::string why) {
  return {Errc::input, "glTF node " + std::to_string(node), std::move(why), ""};
}

// Fills `out` when the member is an array of exactly N numbers; false when it is present but something else.
template <std::size_t N>
bool read_numbers(const Json& object, const char* key, std::array<double, N>& out) {
  const Json& value = member(object, key);
  if (value.is_null()) return true;
  if (!value.is_array() || value.size() != N) return false;
  for (std::size_t i = 0; i < N; ++i) {
    if (!value[i].is_number()) return false;
    out[i] = value[i].get<double>();
    if (!std::isfinite(out[i])) return false;
  }
  return true;
}

Result<Matrix> local_matrix(std::size_t index, const Json& node) {
  Matrix matrix = kIdentity;
  if (!read_numbers(node, "matrix", matrix)) return bad_node(index, "its matrix is not 16 numbers");
  if (member(node, "matrix").is_array()) return matrix;
  Placement placement;
  if (!read_numbers(node, "translation", placement.translation) ||
      !read_numbers(node, "rotation", placement.rotation) || !read_numbers(node, "scale", placement.scale))
    return bad_node(index, "its translation, rotation or scale is not a list of numbers");
  placement.rotation = normalised(placement.rotation);
  return to_matrix(placement);
}

Status read_parents(const Json& nodes, NodeTree& tree) {
  tree.parents.assign(nodes.size(), std::nullopt);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    for (const Json& entry : array_member(nodes[i], "children")) {
      const auto child = to_index(entry);
      if (!child || *child >= nodes.size()) return bad_node(i, "it has a child that does not exist");
      if (tree.parents[*child]) return bad_node(*child, "it has two parents");
      tree.parents[*child] = i;
    }
  }
  return Done{};
}

// Nodes below `roots` and the roots themselves, parents first. Each node has one parent, so none comes twice
// unless a root is also a child.
std::vector<std::size_t> walk(const Json& nodes, std::vector<std::size_t> roots) {
  std::vector<bool> seen(nodes.size());
  std::vector<std::size_t> order;
  for (const std::size_t root : roots) {
    std::vector<std::size_t> open = {root};
    while (!open.empty()) {
      const std::size_t node = open.back();
      open.pop_back();
      if (seen[node]) continue;
      seen[node] = true;
      order.push_back(node);
      const Json& children = array_member(nodes[node], "children");
      for (std::size_t i = children.size(); i-- > 0;) open.push_back(*to_index(children[i]));
    }
  }
  return order;
}

// Last word of a node name in lower case: "mixamorig:Head" -> "head".
std::string last_word(std::string_view name) {
  if (const auto cut = name.find_last_of(":._|/ -"); cut != std::string_view::npos)
    name.remove_prefix(cut + 1);
  std::string word;
  for (const char c : name) word += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return word;
}

// Lowest and highest corner of meshes in the scene, from the bounds that POSITION accessors state (floats
// only).
struct Bounds {
  std::array<double, 3> low = {1e30, 1e30, 1e30}, high = {-1e30, -1e30, -1e30};
  [[nodiscard]] bool empty() const { return low[0] > high[0]; }
};

Bounds bounds_of(const GltfDocument& document, const NodeTree& tree,
                 const std::vector<std::size_t>& mesh_nodes) {
  Bounds bounds;
  const Json& accessors = array_member(document.json, "accessors");
  const Json& meshes = array_member(document.json, "meshes");
  for (const std::size_t node : mesh_nodes) {
    const auto mesh = index_member(document.json["nodes"][node], "mesh");
    if (!mesh || *mesh >= meshes.size()) continue;
    for (const Json& primitive : array_member(meshes[*mesh], "primitives")) {
      const auto accessor = index_member(member(primitive, "attributes"), "POSITION");
      if (!accessor || *accessor >= accessors.size()) continue;
      std::array<std::array<double, 3>, 2> box{};
      const Json& entry = accessors[*accessor];
      if (index_member(entry, "componentType") != kFloat || !member(entry, "min").is_array() ||
          !read_numbers(entry, "min", box[0]) || !read_numbers(entry, "max", box[1]))
        continue;
      for (unsigned corner = 0; corner < 8; ++corner) {
        const auto pick = [&](unsigned axis) { return static_cast<float>(box[corner >> axis & 1u][axis]); };
        const Vec3 p = transform_point(tree.world[node], {pick(0), pick(1), pick(2)});
        const std::array<double, 3> q = {p.x, p.y, p.z};
        for (std::size_t k = 0; k < 3; ++k) {
          bounds.low[k] = std::min(bounds.low[k], q[k]);
          bounds.high[k] = std::max(bounds.high[k], q[k]);
        }
      }
    }
  }
  return bounds;
}

// A head turns about a point in or near it. A node that stands elsewhere, such as on the floor, would swing
// the face through the room.
bool is_near(const NodeTree& tree, std::size_t node, const Bounds& bounds) {
  if (bounds.empty()) return true;
  double distance = 0, size = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double pivot = tree.world[node][12 + k];
    distance = std::max({distance, bounds.low[k] - pivot, pivot - bounds.high[k]});
    size = std::max(size, bounds.high[k] - bounds.low[k]);
  }
  return distance <= size;
}

bool carries(const NodeTree& tree, std::size_t ancestor, std::size_t node) {
  for (std::optional<std::size_t> at = node; at; at = tree.parents[*at])
    if (*at == ancestor) return true;
  return false;
}

}  // namespace

Result<NodeTree> read_nodes(const GltfDocument& document) {
  NodeTree tree;
  const Json& nodes = array_member(document.json, "nodes");
  MIEN_TRY([[maybe_unused]] const auto done, read_parents(nodes, tree));

  std::vector<std::size_t> roots;
  for (std::size_t i = 0; i < nodes.size(); ++i)
    if (!tree.parents[i]) roots.push_back(i);
  const auto order = walk(nodes, roots);
  if (order.size() != nodes.size())
    return Error{Errc::input, "glTF nodes", "some nodes are their own ancestors", ""};

  // Heads of VRM 0.x look along -z, unlike every other glTF character: turn the scene around.
  const Json& extensions = member(document.json, "extensions");
  const bool looks_back =
      member(extensions, "VRM").is_object() && !member(extensions, "VRMC_vrm").is_object();
  Placement base;
  if (looks_back) base.rotation = {0, 1, 0, 0};

  tree.world.assign(nodes.size(), kIdentity);
  tree.world_rotation.assign(nodes.size(), kNoRotation);
  for (const std::size_t i : order) {
    MIEN_TRY(const Matrix local, local_matrix(i, nodes[i]));
    const auto placement = node_placement(nodes[i]);
    const Quaternion rotation = placement ? placement->rotation : kNoRotation;
    const auto parent = tree.parents[i];
    tree.world[i] = multiply(parent ? tree.world[*parent] : to_matrix(base), local);
    tree.world_rotation[i] = multiply(parent ? tree.world_rotation[*parent] : base.rotation, rotation);
    for (const double value : tree.world[i])
      if (!std::isfinite(value)) return bad_node(i, "its place in the scene is not finite");
  }

  tree.in_scene = order;
  const Json& scenes = array_member(document.json, "scenes");
  if (scenes.empty()) return tree;
  const std::size_t scene = index_member(document.json, "scene").value_or(0);
  if (scene >= scenes.size()) return Error{Errc::input, "glTF", "the default scene does not exist", ""};
  roots.clear();
  for (const Json& entry : array_member(scenes[scene], "nodes")) {
    const auto root = to_index(entry);
    if (!root || *root >= nodes.size())
      return Error{Errc::input, "glTF scene", "one of its nodes does not exist", ""};
    roots.push_back(*root);
  }
  tree.in_scene = walk(nodes, roots);
  return tree;
}

std::optional<Placement> node_placement(const Json& node) {
  if (member(node, "matrix").is_array()) {
    Matrix matrix = kIdentity;
    return read_numbers(node, "matrix", matrix) ? decompose(matrix) : std::nullopt;
  }
  Placement placement;
  if (!read_numbers(node, "translation", placement.translation) ||
      !read_numbers(node, "rotation", placement.rotation) || !read_numbers(node, "scale", placement.scale))
    return std::nullopt;
  placement.rotation = normalised(placement.rotation);
  return placement;
}

std::optional<std::size_t> find_head_node(const GltfDocument& document, const NodeTree& tree,
                                          const std::vector<std::size_t>& face_nodes) {
  const Json& nodes = array_member(document.json, "nodes");
  std::vector<bool> is_joint(nodes.size());
  for (const Json& skin : array_member(document.json, "skins"))
    for (const Json& entry : array_member(skin, "joints"))
      if (const auto joint = to_index(entry); joint && *joint < nodes.size()) is_joint[*joint] = true;

  const Bounds face = bounds_of(document, tree, face_nodes);
  std::optional<std::size_t> best;
  std::size_t best_rank = 0;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const std::string name = text_member(nodes[i], "name");
    // The place of a skinned mesh comes from its joints, so turning its node does nothing.
    if (last_word(name) != "head" || member(nodes[i], "skin").is_number() || !node_placement(nodes[i]))
      continue;
    const bool turns_all =
        !face_nodes.empty() &&
        std::all_of(face_nodes.begin(), face_nodes.end(), [&](std::size_t f) { return carries(tree, i, f); });
    if (!is_joint[i] && !(turns_all && is_near(tree, i, face))) continue;
    const std::size_t rank = (is_joint[i] ? 0 : 1000) + name.size();
    if (!best || rank < best_rank) best = i, best_rank = rank;
  }
  return best;
}

}  // namespace mien::io
