#include "mien/io/gltf_reader.h"

#include <algorithm>
#include <map>
#include <set>

#include "gltf_accessor.h"
#include "gltf_nodes.h"
#include "gltf_primitive.h"
#include "mien/base/file.h"
#include "mien/core/arkit.h"
#include "shape_names.h"

namespace mien {
namespace {

using namespace io;

// What becomes of the targets of the meshes, over the whole file.
struct NameReport {
  std::set<std::string> found;         // ARKit names
  std::vector<std::string> left_over;  // targets without one
  std::set<std::string> left_over_seen;
};

ShapePlan plan_shapes(const GltfDocument& document, const Json& mesh, const Json& node, NameReport& report) {
  const auto names = target_names(document, mesh);
  const auto matched = arkit_of(names);
  const Json& own = array_member(node, "weights");
  const Json& weights = own.size() == names.size() ? own : array_member(mesh, "weights");
  ShapePlan plan;
  plan.baked.resize(names.size());
  for (std::size_t t = 0; t < names.size(); ++t) {
    if (!matched[t]) {
      plan.shapes.push_back({names[t], {t}});
      if (report.left_over_seen.insert(names[t]).second) report.left_over.push_back(names[t]);
      if (t < weights.size() && weights[t].is_number()) plan.baked[t] = weights[t].get<float>();
      continue;
    }
    const std::string& name = *matched[t];
    report.found.insert(name);
    const auto known = std::find_if(plan.shapes.begin(), plan.shapes.end(),
                                    [&](const auto& shape) { return shape.name == name; });
    if (known != plan.shapes.end())
      known->targets.push_back(t);
    else
      plan.shapes.push_back({name, {t}});
  }
  return plan;
}

Result<MeshPlacement> place_mesh(const GltfDocument& document, const NodeTree& tree, std::size_t node,
                                 ReadBudget& budget) {
  MeshPlacement placement{tree.world[node], {}};
  const Json& entry = document.json["nodes"][node];
  const auto skin_index = index_member(entry, "skin");
  if (!skin_index) return placement;
  const Json& skins = array_member(document.json, "skins");
  if (*skin_index >= skins.size())
    return Error{Errc::input, "glTF", "a node names a skin that does not exist", ""};
  const Json& skin = skins[*skin_index];
  const Json& joints = array_member(skin, "joints");
  MIEN_TRY([[maybe_unused]] const auto paid, budget.spend(joints.size()));
  std::vector<float> inverse_bind;
  if (const auto accessor = index_member(skin, "inverseBindMatrices")) {
    MIEN_TRY(const auto info, accessor_info(document, *accessor));
    MIEN_TRY([[maybe_unused]] const auto also_paid, budget.spend(info.count));
    MIEN_TRY(inverse_bind, read_floats(document, *accessor, 16));
    if (inverse_bind.size() < joints.size() * 16)
      return Error{Errc::input, "glTF skin", "has fewer inverse bind matrices than joints", ""};
  }
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const auto joint = to_index(joints[j]);
    if (!joint || *joint >= tree.world.size())
      return Error{Errc::input, "glTF skin", "names a joint that does not exist", ""};
    Matrix bind = kIdentity;
    if (!inverse_bind.empty())
      std::copy_n(inverse_bind.begin() + static_cast<std::ptrdiff_t>(j * 16), 16, bind.begin());
    placement.joints.push_back(multiply(tree.world[*joint], bind));
  }
  return placement;
}

std::string part_name(const GltfDocument& document, const Json& node, const Json& mesh,
                      const Json& primitive) {
  if (const auto name = text_member(member(primitive, "extras"), "part"); !name.empty()) return name;
  std::string name = text_member(mesh, "name");
  if (name.empty()) name = text_member(node, "name");
  if (array_member(mesh, "primitives").size() > 1) {
    const Json& materials = array_member(document.json, "materials");
    const auto material = index_member(primitive, "material");
    const std::string suffix =
        material && *material < materials.size() ? text_member(materials[*material], "name") : "";
    if (!suffix.empty()) name += (name.empty() ? "" : ".") + suffix;
  }
  return name.empty() ? "part" : name;
}

std::string unused_name(const std::string& name, std::set<std::string>& used) {
  std::string candidate = name;
  for (int i = 2; !used.insert(candidate).second; ++i) candidate = name + " " + std::to_string(i);
  return candidate;
}

// A part and where it belongs: our own files number their parts.
struct FoundPart {
  CharacterPart part;
  std::size_t order = 0;
  const Json* regions = nullptr;
};

// The skin first: regions refer to it, and pictures and metrics look there.
void sort_parts(std::vector<FoundPart>& parts) {
  std::stable_sort(parts.begin(), parts.end(),
                   [](const FoundPart& a, const FoundPart& b) { return a.order < b.order; });
  const auto has_regions =
      std::find_if(parts.begin(), parts.end(), [](const auto& p) { return p.regions != nullptr; });
  if (has_regions != parts.end()) {
    std::rotate(parts.begin(), has_regions, has_regions + 1);
    return;
  }
  if (parts.front().order != parts.back().order) return;  // numbered
  const auto moved = [](const FoundPart& p) {
    std::size_t rows = 0;
    for (const auto& shape : p.part.shapes)
      if (match_arkit_name(shape.name)) rows += shape.vertices.size();
    return rows;
  };
  const auto most = std::max_element(parts.begin(), parts.end(),
                                     [&](const auto& a, const auto& b) { return moved(a) < moved(b); });
  std::rotate(parts.begin(), most, most + 1);
}

void read_regions(const Json& regions, std::size_t num_vertices, Result<Character>& result) {
  for (const auto& [name, list] : regions.items()) {
    std::vector<std::uint32_t> vertices;
    bool fits = list.is_array();
    for (const Json& entry : list) {
      const auto v = to_index(entry);
      fits = fits && v && *v < num_vertices;
      if (!fits) break;
      vertices.push_back(static_cast<std::uint32_t>(*v));
    }
    if (fits)
      result->regions[name] = std::move(vertices);
    else
      result.warnings.push_back("region '" + name + "' does not fit the skin and is left out");
  }
}

void report_names(const NameReport& report, std::vector<std::string>& warnings) {
  std::vector<std::string> missing;
  for (const auto name : arkit_names())
    if (!report.found.contains(std::string(name))) missing.emplace_back(name);
  if (report.found.empty())
    warnings.push_back("no morph target has an ARKit name: speech will not move this character");
  else if (!missing.empty())
    warnings.push_back("no morph target for: " + listed(missing, 52));
  if (!report.left_over.empty())
    warnings.push_back("morph targets without an ARKit name: " + listed(report.left_over));
}

Result<Character> character_of(const GltfDocument& document) {
  MIEN_TRY(const NodeTree tree, read_nodes(document));
  ReadBudget budget;
  NameReport report;
  std::vector<FoundPart> parts;
  std::set<std::string> used_names;
  std::size_t num_skipped = 0;
  const Json& meshes = array_member(document.json, "meshes");
  for (const std::size_t node_index : tree.in_scene) {
    const Json& node = document.json["nodes"][node_index];
    const auto mesh_index = index_member(node, "mesh");
    if (!mesh_index) continue;
    if (*mesh_index >= meshes.size())
      return Error{Errc::input, "glTF", "a node names a mesh that does not exist", ""};
    const Json& mesh = meshes[*mesh_index];
    MIEN_TRY([[maybe_unused]] const auto paid, budget.spend(num_targets(mesh)));
    const ShapePlan plan = plan_shapes(document, mesh, node, report);
    MIEN_TRY(const MeshPlacement placement, place_mesh(document, tree, node_index, budget));
    for (const Json& primitive : array_member(mesh, "primitives")) {
      auto part = read_primitive(document, primitive, plan, placement, budget);
      if (!part) return within(part.error(), "mesh '" + text_member(mesh, "name") + "'");
      if (!*part) {
        ++num_skipped;
        continue;
      }
      FoundPart found{std::move(**part), 0, nullptr};
      const Json& extras = member(primitive, "extras");
      found.part.name = unused_name(part_name(document, node, mesh, primitive), used_names);
      found.order = index_member(extras, "order").value_or(0);
      if (member(extras, "regions").is_object()) found.regions = &extras["regions"];
      parts.push_back(std::move(found));
    }
  }
  if (parts.empty())
    return Error{Errc::incompatible, "glTF", "there are no triangles in its scene",
                 "Export the character as a mesh"};
  sort_parts(parts);

  Result<Character> result{Character{}};
  const Json& scenes = array_member(document.json, "scenes");
  const std::size_t scene = index_member(document.json, "scene").value_or(0);
  if (scene < scenes.size()) result->name = text_member(scenes[scene], "name");
  if (parts.front().regions != nullptr)
    read_regions(*parts.front().regions, parts.front().part.mesh.positions.size(), result);
  for (FoundPart& found : parts) result->parts.push_back(std::move(found.part));
  report_names(report, result.warnings);
  if (num_skipped > 0)
    result.warnings.push_back(std::to_string(num_skipped) + " primitives are points or lines");
  return result;
}

}  // namespace

Result<Character> read_glb(std::span<const std::byte> bytes) {
  MIEN_TRY(const GltfDocument document, parse_gltf(bytes));
  return character_of(document);
}

Result<Character> read_glb(const std::filesystem::path& path) {
  MIEN_TRY(const Bytes bytes, read_file(path));
  const auto folder = path.parent_path();
  const auto document = parse_gltf(bytes, &folder);
  if (!document) return within(document.error(), "'" + path.string() + "'");
  auto character = character_of(*document);
  if (!character) return within(character.error(), "'" + path.string() + "'");
  if (character->name.empty()) character->name = path.stem().string();
  return character;
}

}  // namespace mien
