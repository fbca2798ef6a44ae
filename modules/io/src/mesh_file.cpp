#include "mien/io/mesh_file.h"

#include <algorithm>
#include <cctype>

#include "mien/base/file.h"
#include "mien/io/character_file.h"

namespace mien {
namespace {

Result<Mesh> read_known(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (extension == ".glb" || extension == ".gltf" || extension == ".vrm" || extension == ".safetensors") {
    auto character = load_character(path);
    if (!character) return character.error();
    Result<Mesh> mesh(merged_mesh(*character));
    mesh.warnings = std::move(character.warnings);
    return mesh;
  }
  if (extension != ".obj" && extension != ".ply")
    return Error{Errc::usage, "mesh", "no mesh has the extension '" + extension + "'",
                 "Use .obj, .ply, or a character (.glb .gltf .vrm .safetensors)"};
  MIEN_TRY(const Bytes bytes, read_file(path));
  return extension == ".obj" ? read_obj(as_text(bytes)) : read_ply(bytes);
}

}  // namespace

Mesh merged_mesh(const Character& character) {
  const bool colored = std::all_of(character.parts.begin(), character.parts.end(),
                                   [](const CharacterPart& part) { return !part.mesh.colors.empty(); });
  Mesh merged;
  for (const auto& part : character.parts) {
    const auto first = static_cast<std::uint32_t>(merged.positions.size());
    for (const auto& t : part.mesh.triangles)
      merged.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    merged.positions.insert(merged.positions.end(), part.mesh.positions.begin(), part.mesh.positions.end());
    if (colored) merged.colors.insert(merged.colors.end(), part.mesh.colors.begin(), part.mesh.colors.end());
  }
  return merged;
}

std::vector<Blendshape> merged_shapes(const Character& character) {
  std::vector<Blendshape> merged;
  std::uint32_t first = 0;
  for (const auto& part : character.parts) {
    for (const auto& shape : part.shapes) {
      auto same =
          std::find_if(merged.begin(), merged.end(), [&](const auto& s) { return s.name == shape.name; });
      if (same == merged.end()) same = merged.insert(merged.end(), Blendshape{shape.name, {}, {}, {}});
      for (const auto v : shape.vertices) same->vertices.push_back(first + v);
      same->offsets.insert(same->offsets.end(), shape.offsets.begin(), shape.offsets.end());
    }
    first += static_cast<std::uint32_t>(part.mesh.positions.size());
  }
  return merged;
}

Result<Mesh> load_mesh(const std::filesystem::path& path) {
  auto mesh = read_known(path);
  const std::string name = "'" + path.string() + "'";
  if (!mesh && !mesh.error().what.starts_with(name)) return within(mesh.error(), name);
  if (mesh && mesh->positions.empty()) return Error{Errc::input, name, "the mesh has no vertices", ""};
  return mesh;
}

}  // namespace mien
