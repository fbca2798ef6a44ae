#include "mien/io/gltf_writer.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <set>

#include "capitalised.h"
#include "gltf_builder.h"
#include "gltf_component_type.h"
#include "mien/core/arkit.h"

namespace mien {
namespace {

using namespace io;

constexpr int kPoints = 0;  // primitive.mode

bool is_finite(Vec3 p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

void check_shape(const CharacterPart& part, const Blendshape& shape) {
  const std::string where = "write_glb: shape '" + shape.name + "' of '" + part.name + "': ";
  contract(shape.offsets.size() == shape.vertices.size(), where + "one offset per vertex expected");
  contract(shape.normal_offsets.empty() || shape.normal_offsets.size() == shape.vertices.size(),
           where + "one normal offset per vertex expected");
  for (std::size_t i = 0; i < shape.vertices.size(); ++i) {
    contract(shape.vertices[i] < part.mesh.positions.size() &&
                 (i == 0 || shape.vertices[i] > shape.vertices[i - 1]),
             where + "its vertices do not rise or do not exist");
    contract(is_finite(shape.offsets[i]), where + "an offset is not finite");
    contract(shape.normal_offsets.empty() || is_finite(shape.normal_offsets[i]),
             where + "a normal is not finite");
  }
}

void check(const CharacterPart& part) {
  const std::string where = "write_glb: part '" + part.name + "': ";
  const Mesh& mesh = part.mesh;
  const std::size_t num_vertices = mesh.positions.size();
  contract(num_vertices > 0, where + "no vertices");
  contract(mesh.normals.empty() || mesh.normals.size() == num_vertices,
           where + "one normal per vertex expected");
  contract(mesh.colors.empty() || mesh.colors.size() == num_vertices,
           where + "one colour per vertex expected");
  for (const Vec3 p : mesh.positions) contract(is_finite(p), where + "a position is not finite");
  for (const auto& triangle : mesh.triangles)
    for (const auto v : triangle)
      contract(v < num_vertices, where + "a triangle names a vertex that does not exist");
  std::set<std::string> names;
  for (const Blendshape& shape : part.shapes) {
    contract(names.insert(shape.name).second, where + "two shapes are called '" + shape.name + "'");
    check_shape(part, shape);
  }
}

// glTF wants unit length; anything without a direction points out of the face.
std::vector<Vec3> unit_normals(const Mesh& mesh) {
  auto normals = mesh.normals.empty() ? vertex_normals(mesh.positions, mesh.triangles) : mesh.normals;
  for (Vec3& n : normals) {
    const float size = length(n);
    n = size > 1e-20f && std::isfinite(size) ? (1.0f / size) * n : Vec3{0, 0, 1};
    // A tiny vector may stay off unit length after one division in float.
    if (std::abs(length(n) - 1.0f) > 1e-4f) n = Vec3{0, 0, 1};
  }
  return normals;
}

// Rows of one morph attribute.
struct Rows {
  std::vector<std::uint32_t> vertices;
  std::vector<Vec3> values;
};

Rows position_rows(const Blendshape& shape) { return {shape.vertices, shape.offsets}; }

// Normal displacements of a shape at coefficient 1, where they are visible (0.06 degrees).
// The change of the computed normal is added to the normal of the file, which may have been made in another
// way.
Rows normal_rows(const Mesh& mesh, const std::vector<Vec3>& computed_rest, const Blendshape& shape) {
  if (!shape.normal_offsets.empty()) return {shape.vertices, shape.normal_offsets};
  constexpr float kVisible = 1e-3f;
  std::vector<Vec3> moved = mesh.positions;
  for (std::size_t i = 0; i < shape.vertices.size(); ++i) moved[shape.vertices[i]] += shape.offsets[i];
  const auto after = vertex_normals(moved, mesh.triangles);
  Rows rows;
  for (std::size_t v = 0; v < after.size(); ++v) {
    const Vec3 d = after[v] - computed_rest[v];
    if (length(d) < kVisible) continue;
    rows.vertices.push_back(static_cast<std::uint32_t>(v));
    rows.values.push_back(d);
  }
  return rows;
}

// The sparse rows of all targets of one primitive go into two shared bufferViews, for short JSON.
class SparseRows {
 public:
  explicit SparseRows(std::size_t num_vertices)
      : num_vertices_(num_vertices), index_type_(num_vertices <= 65536 ? kUnsignedShort : kUnsignedInt) {}

  /// Entry of an accessor; its bufferViews are filled in by finish().
  Json add(Rows rows, bool with_bounds) {
    if (rows.vertices.empty()) rows = {{0}, {Vec3{}}};  // a sparse accessor needs one row
    Json accessor = {{"componentType", kFloat}, {"type", "VEC3"}, {"count", num_vertices_}};
    const std::size_t index_offset = add_indices(rows.vertices);
    accessor["sparse"] = {{"count", rows.vertices.size()},
                          {"indices", {{"componentType", index_type_}, {"byteOffset", index_offset}}},
                          {"values", {{"byteOffset", values_.size() * sizeof(Vec3)}}}};
    if (with_bounds) {
      Vec3 low = rows.values[0], high = rows.values[0];
      if (rows.values.size() < num_vertices_) rows.values.push_back({});  // the untouched rest
      for (const Vec3 p : rows.values) {
        low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
      }
      if (rows.values.size() > rows.vertices.size()) rows.values.pop_back();
      accessor["min"] = {low.x, low.y, low.z};
      accessor["max"] = {high.x, high.y, high.z};
    }
    values_.insert(values_.end(), rows.values.begin(), rows.values.end());
    return accessor;
  }

  /// Adds the views and points `accessors` at them.
  void finish(GltfBuilder& builder, const std::vector<std::size_t>& accessors) {
    const std::size_t indices = builder.add_view(indices_, GltfBuilder::kNone);
    const std::size_t values = builder.add_view(values_, GltfBuilder::kNone);
    for (const std::size_t a : accessors) {
      builder.json["accessors"][a]["sparse"]["indices"]["bufferView"] = indices;
      builder.json["accessors"][a]["sparse"]["values"]["bufferView"] = values;
    }
  }

 private:
  // Position and normal rows of a shape often sit on the same vertices: then they share the list.
  std::size_t add_indices(const std::vector<std::uint32_t>& vertices) {
    if (vertices == last_vertices_) return last_offset_;
    last_vertices_ = vertices;
    last_offset_ = indices_.size();
    for (const std::uint32_t v : vertices) {
      if (index_type_ == kUnsignedShort)
        append_le(indices_, static_cast<std::uint16_t>(v));
      else
        append_le(indices_, v);
    }
    return last_offset_;
  }

  std::size_t num_vertices_;
  int index_type_;
  Bytes indices_;
  std::vector<Vec3> values_;
  std::vector<std::uint32_t> last_vertices_;
  std::size_t last_offset_ = 0;
};

Json add_targets(GltfBuilder& builder, const CharacterPart& part, const std::vector<std::string>& names,
                 bool with_normals) {
  const auto rest = vertex_normals(part.mesh.positions, part.mesh.triangles);
  SparseRows rows(part.mesh.positions.size());
  std::vector<std::size_t> accessors;
  Json targets = Json::array();
  for (const std::string& name : names) {
    const auto found =
        std::find_if(part.shapes.begin(), part.shapes.end(), [&](const auto& s) { return s.name == name; });
    const Blendshape nothing{name, {}, {}, {}};
    const Blendshape& shape = found == part.shapes.end() ? nothing : *found;
    Json target;
    accessors.push_back(builder.add_accessor(rows.add(position_rows(shape), true)));
    target["POSITION"] = accessors.back();
    if (with_normals) {
      Rows normals = shape.vertices.empty() ? Rows{} : normal_rows(part.mesh, rest, shape);
      accessors.push_back(builder.add_accessor(rows.add(std::move(normals), false)));
      target["NORMAL"] = accessors.back();
    }
    targets.push_back(std::move(target));
  }
  rows.finish(builder, accessors);
  return targets;
}

std::size_t add_positions(GltfBuilder& builder, const std::vector<Vec3>& positions) {
  Vec3 low = positions[0], high = positions[0];
  for (const Vec3 p : positions) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const std::size_t view = builder.add_view(positions, GltfBuilder::kVertices);
  return builder.add_accessor({{"bufferView", view},
                               {"componentType", kFloat},
                               {"type", "VEC3"},
                               {"count", positions.size()},
                               {"min", {low.x, low.y, low.z}},
                               {"max", {high.x, high.y, high.z}}});
}

std::size_t add_normals(GltfBuilder& builder, const std::vector<Vec3>& normals) {
  const std::size_t view = builder.add_view(normals, GltfBuilder::kVertices);
  return builder.add_accessor(
      {{"bufferView", view}, {"componentType", kFloat}, {"type", "VEC3"}, {"count", normals.size()}});
}

std::size_t add_colors(GltfBuilder& builder, const std::vector<std::array<float, 4>>& colors) {
  std::vector<std::uint16_t> packed;
  packed.reserve(colors.size() * 4);
  for (const auto& color : colors)
    for (const float c : color)
      packed.push_back(static_cast<std::uint16_t>(std::lround(65535.0 * (c > 0 ? std::min(c, 1.0f) : 0.0f))));
  const std::size_t view = builder.add_view(packed, GltfBuilder::kVertices);
  return builder.add_accessor({{"bufferView", view},
                               {"componentType", kUnsignedShort},
                               {"normalized", true},
                               {"type", "VEC4"},
                               {"count", colors.size()}});
}

std::size_t add_triangles(GltfBuilder& builder, const Mesh& mesh) {
  // 255 and 65535 mark a restart in some graphics interfaces, so they may not be used as indices.
  const std::size_t num_vertices = mesh.positions.size();
  const int type = num_vertices <= 255     ? kUnsignedByte
                   : num_vertices <= 65535 ? kUnsignedShort
                                           : kUnsignedInt;
  Bytes bytes;
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t v : triangle) {
      if (type == kUnsignedByte)
        append_le(bytes, static_cast<std::uint8_t>(v));
      else if (type == kUnsignedShort)
        append_le(bytes, static_cast<std::uint16_t>(v));
      else
        append_le(bytes, v);
    }
  const std::size_t view = builder.add_view(bytes, GltfBuilder::kIndices);
  return builder.add_accessor({{"bufferView", view},
                               {"componentType", type},
                               {"type", "SCALAR"},
                               {"count", mesh.triangles.size() * 3}});
}

// Looks by part name; the colour is used where a part has no vertex colours (linear RGB).
Json material_of(const CharacterPart& part) {
  struct Look {
    std::string_view word;
    std::array<double, 3> color;
    double roughness;
    bool double_sided;
  };
  static constexpr Look kLooks[] = {
      {"skin", {0.60, 0.36, 0.27}, 0.55, false},  {"eye", {0.80, 0.78, 0.75}, 0.15, false},
      {"teeth", {0.75, 0.70, 0.60}, 0.25, false}, {"tongue", {0.45, 0.15, 0.14}, 0.40, false},
      {"mouth", {0.45, 0.15, 0.14}, 0.40, false}, {"brow", {0.06, 0.04, 0.03}, 0.80, true},
      {"lash", {0.03, 0.02, 0.015}, 0.80, true},  {"hair", {0.06, 0.04, 0.03}, 0.70, true}};
  Look look{"", {0.60, 0.36, 0.27}, 0.6, false};
  for (const Look& candidate : kLooks)
    if (part.name.find(candidate.word) != std::string::npos) {
      look = candidate;
      break;
    }
  const auto color = part.mesh.colors.empty() ? look.color : std::array<double, 3>{1, 1, 1};
  Json material = {{"name", part.name},
                   {"pbrMetallicRoughness",
                    {{"baseColorFactor", {color[0], color[1], color[2], 1.0}},
                     {"metallicFactor", 0.0},
                     {"roughnessFactor", look.roughness}}}};
  if (look.double_sided) material["doubleSided"] = true;
  return material;
}

Json add_primitive(GltfBuilder& builder, const Character& character, std::size_t index,
                   const std::vector<std::string>& targets, const GltfWriteOptions& options) {
  const CharacterPart& part = character.parts[index];
  const bool is_points = part.mesh.triangles.empty();
  Json primitive;
  primitive["attributes"]["POSITION"] = add_positions(builder, part.mesh.positions);
  if (!is_points) primitive["attributes"]["NORMAL"] = add_normals(builder, unit_normals(part.mesh));
  if (!part.mesh.colors.empty()) primitive["attributes"]["COLOR_0"] = add_colors(builder, part.mesh.colors);
  if (is_points)
    primitive["mode"] = kPoints;
  else
    primitive["indices"] = add_triangles(builder, part.mesh);
  if (!targets.empty())
    primitive["targets"] = add_targets(builder, part, targets, options.normals && !is_points);
  builder.json["materials"].push_back(material_of(part));
  primitive["material"] = builder.json["materials"].size() - 1;
  primitive["extras"] = {{"part", part.name}, {"order", index}};
  if (index == 0 && !character.regions.empty()) primitive["extras"]["regions"] = character.regions;
  return primitive;
}

// Names of all shapes: ARKit's in their order, then the others as they come.
std::vector<std::string> all_targets(const Character& character) {
  std::vector<std::string> others;
  std::set<std::string> seen;
  for (const auto& part : character.parts)
    for (const auto& shape : part.shapes)
      if (seen.insert(shape.name).second) others.push_back(shape.name);
  std::vector<std::string> names;
  for (const auto name : arkit_names())
    if (seen.contains(std::string(name))) names.emplace_back(name);
  const std::set<std::string> first(names.begin(), names.end());
  for (const auto& name : others)
    if (!first.contains(name)) names.push_back(name);
  return names;
}

void add_mesh(GltfBuilder& builder, Json mesh, Vec3 pivot) {
  Json& nodes = builder.json["nodes"];
  nodes.push_back({{"name", mesh["name"]}, {"mesh", builder.json["meshes"].size()}});
  if (pivot != Vec3{}) nodes.back()["translation"] = {-pivot.x, -pivot.y, -pivot.z};
  nodes[0]["children"].push_back(nodes.size() - 1);
  builder.json["meshes"].push_back(std::move(mesh));
}

}  // namespace

Result<Bytes> write_glb(const Character& character, const GltfWriteOptions& options) {
  contract(!character.parts.empty(), "write_glb: the character has no parts");
  for (const auto& part : character.parts) check(part);
  for (const auto& [name, vertices] : character.regions)
    for (const auto v : vertices)
      contract(v < character.parts[0].mesh.positions.size(),
               "write_glb: region '" + name + "' leaves the skin");

  GltfBuilder builder;
  builder.json["asset"] = {{"version", "2.0"}, {"generator", "Mien"}};
  if (!options.extras.empty()) {
    Json extras = Json::parse(options.extras, nullptr, /*allow_exceptions=*/false);
    contract(extras.is_object(), "write_glb: the extras are not a JSON object");
    builder.json["asset"]["extras"] = std::move(extras);
  }
  builder.json["scene"] = 0;
  builder.json["scenes"] = Json::array({{{"nodes", {0}}}});
  if (!character.name.empty()) builder.json["scenes"][0]["name"] = character.name;
  builder.json["nodes"] = Json::array({{{"name", "Head"}}});
  const Vec3 pivot = options.pivot;
  contract(std::isfinite(pivot.x) && std::isfinite(pivot.y) && std::isfinite(pivot.z),
           "write_glb: the pivot is not finite");
  if (pivot != Vec3{}) builder.json["nodes"][0]["translation"] = {pivot.x, pivot.y, pivot.z};
  builder.json["meshes"] = Json::array();

  const auto targets = all_targets(character);
  if (!targets.empty()) {
    Json face = {{"name", "Face"}, {"primitives", Json::array()}};
    for (std::size_t i = 0; i < character.parts.size(); ++i)
      if (!character.parts[i].shapes.empty())
        face["primitives"].push_back(add_primitive(builder, character, i, targets, options));
    face["weights"] = std::vector<double>(targets.size(), 0.0);
    face["extras"]["targetNames"] = targets;
    add_mesh(builder, std::move(face), pivot);
  }
  for (std::size_t i = 0; i < character.parts.size(); ++i) {
    if (!character.parts[i].shapes.empty()) continue;
    add_mesh(builder,
             {{"name", capitalised(character.parts[i].name)},
              {"primitives", Json::array({add_primitive(builder, character, i, {}, options)})}},
             pivot);
  }
  return builder.finish();
}

}  // namespace mien
