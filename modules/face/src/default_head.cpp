#include "mien/face/default_head.h"

#include <cmath>

#include "head/head_model.h"
#include "head/tables.h"
#include "mien/core/arkit.h"
#include "mien/face/regions.h"

namespace mien {
namespace {

using head::MovingPart;
using head::Offsets;
using head::Vec3d;

// Centimetres to metres; the face is shortened a little.
constexpr Vec3d kToMetres{0.01, 0.0094, 0.01};
Vec3 in_metres(Vec3d p) {
  return {static_cast<float>(p.x * kToMetres.x), static_cast<float>(p.y * kToMetres.y),
          static_cast<float>(p.z * kToMetres.z)};
}

// Rows below both are dropped: a micrometre, a twentieth of a degree.
constexpr float kMinOffset = 1e-6f;        // metres
constexpr float kMinNormalOffset = 1e-3f;  // of a unit vector

// A part of the character is one or several parts of the model, one after the other.
void append(Mesh& mesh, const head::Part& part) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (const Vec3d& p : part.positions) mesh.positions.push_back(in_metres(p));
  for (const auto& [a, b, c] : part.triangles) mesh.triangles.push_back({first + a, first + b, first + c});
  for (const auto& rgb : part.colors)
    mesh.colors.push_back(
        {static_cast<float>(rgb[0]), static_cast<float>(rgb[1]), static_cast<float>(rgb[2]), 1.0f});
}

Blendshape sparse_shape(std::string_view name, const Mesh& mesh, const std::vector<Vec3>& offsets) {
  std::vector<Vec3> moved = mesh.positions;
  for (std::size_t v = 0; v < moved.size(); ++v) moved[v] += offsets[v];
  const auto normals = vertex_normals(moved, mesh.triangles);
  Blendshape shape{std::string(name), {}, {}, {}};
  for (std::uint32_t v = 0; v < moved.size(); ++v) {
    const Vec3 turn = normals[v] - mesh.normals[v];
    if (length(offsets[v]) <= kMinOffset && length(turn) <= kMinNormalOffset) continue;
    shape.vertices.push_back(v);
    shape.offsets.push_back(offsets[v]);
    shape.normal_offsets.push_back(turn);
  }
  return shape;
}

CharacterPart assemble(std::string name, std::span<const MovingPart> members, bool keep_empty_shapes) {
  CharacterPart part{std::move(name), {}, {}};
  for (const MovingPart& member : members) append(part.mesh, member.mesh);
  part.mesh.normals = vertex_normals(part.mesh.positions, part.mesh.triangles);
  for (std::size_t k = 0; k < kNumArkit; ++k) {
    std::vector<Vec3> offsets;
    for (const MovingPart& member : members) {
      if (k < member.shapes.size() && !member.shapes[k].empty())
        for (const Vec3d& d : member.shapes[k]) offsets.push_back(in_metres(d));
      else
        offsets.resize(offsets.size() + member.mesh.positions.size());
    }
    Blendshape shape = sparse_shape(arkit_names()[k], part.mesh, offsets);
    if (keep_empty_shapes || !shape.vertices.empty()) part.shapes.push_back(std::move(shape));
  }
  return part;
}

}  // namespace

DefaultHead build_default_head(int num_threads) {
  const head::HeadModel model = head::build_head_model(num_threads);
  struct PartGroup {
    const char* name;
    std::size_t first, count;  // in model.parts
  };
  constexpr std::array<PartGroup, 8> kGroups = {{{"skin", 0, 1},
                                                 {"eyes", 1, 4},
                                                 {"teeth", 5, 2},
                                                 {"tongue", 7, 1},
                                                 {"brows", 8, 2},
                                                 {"lashes", 10, 2},
                                                 {"ears", 12, 2},
                                                 {"hair", 14, 1}}};
  DefaultHead out;
  out.character.name = "Mien default head";
  for (const auto& [name, first, count] : kGroups)
    out.character.parts.push_back(assemble(name, std::span(model.parts).subspan(first, count), first == 0));
  out.character.regions[std::string(kLipsRegion)] = head::lip_region(model.skin);
  out.character.regions[std::string(kUpperFaceRegion)] = head::upper_face_region(model.skin);
  out.character.regions[std::string(kLandmarksRegion)] = head::landmarks68(model.skin);
  out.mirror = model.skin.mirror;
  out.handles.insert(model.handles.begin(), model.handles.end());
  out.rings = head::named_rings(model.skin);
  return out;
}

Character default_head(int num_threads) { return build_default_head(num_threads).character; }

}  // namespace mien
