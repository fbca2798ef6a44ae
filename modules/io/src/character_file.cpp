#include "mien/io/character_file.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "blendshape_folder.h"
#include "mien/core/arkit.h"
#include "mien/io/file_extension.h"
#include "mien/io/gltf_reader.h"
#include "mien/io/safetensors.h"
#include "shape_names.h"

namespace mien {
namespace {

Result<double> metres_per_unit(const Metadata& metadata) {
  const auto entry = metadata.find("units");
  if (entry == metadata.end()) return 1.0;
  const std::string& units = entry->second;
  for (const auto& [word, size] : {std::pair{"centimet", 0.01}, {"millimet", 0.001}, {"met", 1.0}})
    if (units.starts_with(word)) return size;
  for (const auto& [word, size] : {std::pair{"cm", 0.01}, {"mm", 0.001}, {"m", 1.0}})
    if (units == word) return size;
  return Error{Errc::incompatible, "metadata 'units'",
               "'" + units + "' is unknown, expected metres, centimetres or millimetres", ""};
}

Result<std::vector<Vec3>> read_points(const SafetensorsFile& file, const std::string& name,
                                      std::int64_t num_vertices, double scale) {
  const std::array<std::int64_t, 2> shape = {num_vertices, 3};
  MIEN_TRY([[maybe_unused]] const auto* tensor, file.expect(name, shape));
  MIEN_TRY(const auto values, file.read_float(name));
  std::vector<Vec3> points(values.size() / 3);
  const auto scaled = [&](std::size_t i) { return static_cast<float>(scale * values[i]); };
  for (std::size_t v = 0; v < points.size(); ++v) {
    points[v] = {scaled(3 * v), scaled(3 * v + 1), scaled(3 * v + 2)};
    if (!std::isfinite(points[v].x) || !std::isfinite(points[v].y) || !std::isfinite(points[v].z))
      return Error{Errc::input, "tensor '" + name + "'", "row " + std::to_string(v) + " is not finite", ""};
  }
  return points;
}

Result<std::vector<std::uint32_t>> read_vertices(const SafetensorsFile& file, const std::string& name,
                                                 std::size_t num_vertices) {
  MIEN_TRY(const auto values, file.as<std::int32_t>(name));
  std::vector<std::uint32_t> vertices;
  vertices.reserve(values.size());
  for (const std::int32_t v : values) {
    if (v < 0 || static_cast<std::size_t>(v) >= num_vertices)
      return Error{Errc::input, "tensor '" + name + "'",
                   "vertex " + std::to_string(v) + " of " + std::to_string(num_vertices), ""};
    vertices.push_back(static_cast<std::uint32_t>(v));
  }
  return vertices;
}

Blendshape sparse_shape(std::string name, const std::vector<Vec3>& offsets) {
  Blendshape shape{std::move(name), {}, {}, {}};
  for (std::size_t v = 0; v < offsets.size(); ++v) {
    if (offsets[v] == Vec3{}) continue;
    shape.vertices.push_back(static_cast<std::uint32_t>(v));
    shape.offsets.push_back(offsets[v]);
  }
  return shape;
}

// ARKit names first and in their order, as in the .glb files of write_glb().
void sort_shapes(std::vector<Blendshape>& shapes) {
  const auto rank = [](const Blendshape& shape) {
    const auto names = arkit_names();
    return std::find(names.begin(), names.end(), shape.name) - names.begin();
  };
  std::stable_sort(shapes.begin(), shapes.end(),
                   [&](const Blendshape& a, const Blendshape& b) { return rank(a) < rank(b); });
}

Status read_shapes(const SafetensorsFile& file, double scale, CharacterPart& part,
                   Result<Character>& result) {
  std::vector<std::string> names, tensors, unused, unmatched;
  constexpr std::string_view kShape = "shape.", kRegion = "region.";
  for (const StoredTensor& tensor : file.tensors()) {
    const std::string& name = tensor.name;
    if (name.starts_with(kShape)) {
      names.push_back(name.substr(kShape.size()));
      tensors.push_back(name);
    } else if (name.starts_with(kRegion) || name == "landmarks68") {
      const std::string region = name.starts_with(kRegion) ? name.substr(kRegion.size()) : name;
      MIEN_TRY(result->regions[region], read_vertices(file, name, part.mesh.positions.size()));
    } else if (name != "neutral" && name != "triangles") {
      unused.push_back(name);
    }
  }
  const auto matched = io::arkit_of(names);
  for (std::size_t i = 0; i < names.size(); ++i) {
    MIEN_TRY(const auto offsets,
             read_points(file, tensors[i], static_cast<std::int64_t>(part.mesh.positions.size()), scale));
    Blendshape shape = sparse_shape(matched[i].value_or(names[i]), offsets);
    if (!matched[i]) unmatched.push_back(names[i]);
    if (!shape.vertices.empty()) part.shapes.push_back(std::move(shape));
  }
  sort_shapes(part.shapes);
  std::vector<std::string> missing;
  for (const auto name : arkit_names())
    if (std::find(matched.begin(), matched.end(), std::string(name)) == matched.end())
      missing.emplace_back(name);
  if (missing.size() == kNumArkit)
    result.warnings.emplace_back("no shape has an ARKit name: speech will not move this character");
  else if (!missing.empty())
    result.warnings.push_back("no shape for: " + io::listed(missing, kNumArkit));
  if (!unmatched.empty()) result.warnings.push_back("shapes without an ARKit name: " + io::listed(unmatched));
  if (!unused.empty()) result.warnings.push_back("tensors that are not used: " + io::listed(unused));
  return Done{};
}

Result<Character> read_safetensors_character(const std::filesystem::path& path) {
  MIEN_TRY(const auto file, SafetensorsFile::open(path));
  MIEN_TRY(const double scale, metres_per_unit(file.metadata()));
  CharacterPart part{"skin", {}, {}};
  MIEN_TRY(part.mesh.positions, read_points(file, "neutral", -1, scale));
  const std::array<std::int64_t, 2> triangle_shape = {-1, 3};
  MIEN_TRY([[maybe_unused]] const auto* triangles, file.expect("triangles", triangle_shape));
  MIEN_TRY(const auto corners, read_vertices(file, "triangles", part.mesh.positions.size()));
  for (std::size_t i = 0; i + 2 < corners.size(); i += 3)
    part.mesh.triangles.push_back({corners[i], corners[i + 1], corners[i + 2]});
  if (part.mesh.triangles.empty()) return Error{Errc::incompatible, "tensor 'triangles'", "it is empty", ""};

  Result<Character> result{Character{}};
  MIEN_TRY([[maybe_unused]] const auto shapes, read_shapes(file, scale, part, result));
  const auto name = file.metadata().find("name");
  result->name = name == file.metadata().end() ? path.stem().string() : name->second;
  result->parts.push_back(std::move(part));
  return result;
}

}  // namespace

Result<Character> load_character(const std::filesystem::path& path) {
  std::error_code problem;
  if (std::filesystem::is_directory(path, problem)) return io::read_blendshape_folder(path);
  const std::string extension = lower_extension(path);
  if (extension == ".glb" || extension == ".gltf" || extension == ".vrm") return read_glb(path);
  if (extension != ".safetensors")
    return Error{Errc::incompatible, "character '" + path.string() + "'",
                 "the extension '" + extension +
                     "' is unknown, expected .glb, .gltf, .vrm, .safetensors or a "
                     "folder of meshes",
                 ""};
  auto character = read_safetensors_character(path);
  if (!character) return within(character.error(), "character '" + path.string() + "'");
  return character;
}

}  // namespace mien
