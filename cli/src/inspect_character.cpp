#include <set>

#include "inspect.h"
#include "mien/base/file.h"
#include "mien/console/console_exit.h"
#include "mien/core/arkit.h"
#include "mien/io/character_file.h"
#include "mien/io/gltf_animation.h"

namespace mien {

Result<Facts> inspect_character(const std::filesystem::path& path) {
  auto character = load_character(path);
  if (!character) return character.error();
  Facts facts;
  facts.add("kind", "character");
  facts.add("file", path.string());
  facts.add("name", character->name);
  std::set<std::string_view> shapes;
  std::size_t num_vertices = 0, num_triangles = 0;
  std::string text, json;
  for (const auto& part : character->parts) {
    const std::string vertices = std::to_string(part.mesh.positions.size());
    const std::string triangles = std::to_string(part.mesh.triangles.size());
    const std::string count = std::to_string(part.shapes.size());
    text +=
        "  " + part.name + ": " + vertices + " vertices, " + triangles + " triangles, " + count + " shapes\n";
    json += (json.empty() ? "{\"name\":" : ",{\"name\":") + json_string(part.name) +
            ",\"vertices\":" + vertices + ",\"triangles\":" + triangles + ",\"shapes\":" + count + "}";
    num_vertices += part.mesh.positions.size();
    num_triangles += part.mesh.triangles.size();
    for (const auto& shape : part.shapes) shapes.insert(shape.name);
  }
  facts.add("vertices", static_cast<std::int64_t>(num_vertices));
  facts.add("triangles", static_cast<std::int64_t>(num_triangles));
  std::vector<std::string> missing, others;
  for (const auto name : arkit_names())
    if (shapes.erase(name) == 0) missing.emplace_back(name);
  others.assign(shapes.begin(), shapes.end());
  facts.add("arkit_shapes", static_cast<std::int64_t>(kNumArkit - missing.size()));
  facts.add("missing_shapes", missing);
  facts.add("other_shapes", others);
  std::vector<std::string> regions;
  for (const auto& [name, vertices] : character->regions) regions.push_back(name);
  facts.add("regions", regions);
  facts.add_table("parts", std::move(text), "[" + json + "]");
  if (path.extension() != ".safetensors") {
    MIEN_TRY(const Bytes bytes, read_file(path));
    if (const auto motion = read_glb_motion(bytes)) add_motion_facts(*motion, facts);
  }
  Result<Facts> result = std::move(facts);
  result.warnings = std::move(character.warnings);
  return result;
}

}  // namespace mien
