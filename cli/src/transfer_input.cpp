#include "transfer_input.h"

#include <algorithm>
#include <cctype>
#include <filesystem>

#include "mien/base/file.h"
#include "mien/base/number_text.h"
#include "mien/face/flame.h"
#include "mien/io/character_file.h"
#include "mien/io/flame_file.h"
#include "mien/io/index_list.h"
#include "mien/io/mesh_file.h"

namespace mien {
namespace {

namespace fs = std::filesystem;

// Between an insect's and a statue's: outside of it the unit is wrong.
constexpr float kSmallestHead = 0.05f, kLargestHead = 3;

float largest_extent(const Mesh& mesh) {
  Vec3 low = mesh.positions.front(), high = low;
  for (const Vec3& p : mesh.positions) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  return std::max({high.x - low.x, high.y - low.y, high.z - low.z});
}

std::size_t num_vertices(const Character& character) {
  std::size_t count = 0;
  for (const auto& part : character.parts) count += part.mesh.positions.size();
  return count;
}

// Landmarks of a character: of a file, else its own.
Result<std::vector<std::uint32_t>> landmarks_of(const std::string& file, const Character& character,
                                                const std::string& option) {
  if (!file.empty()) {
    MIEN_TRY(const Bytes bytes, read_file(file));
    auto list = read_index_list(as_text(bytes), num_vertices(character));
    if (!list) return within(list.error(), "'" + file + "'");
    return list;
  }
  const auto own = character.regions.find("landmarks68");
  if (own == character.regions.end())
    return Error{Errc::usage, "markers", "'" + character.name + "' has no landmarks of its own",
                 "Pass --markers FILE with pairs of vertices, or " + option + " FILE with a vertex a line"};
  return own->second;
}

}  // namespace

Result<Character> load_target(const std::string& path, const std::string& unit) {
  const fs::path file(path);
  std::string extension = file.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (extension == ".pkl" || extension == ".npz") {
    MIEN_TRY(const FlameModel model, read_flame_model(file));
    return Character{file.stem().string(), {{"skin", flame_mesh(model), {}}}, {}};
  }
  if (extension != ".obj" && extension != ".ply") return load_character(file);
  auto mesh = load_mesh(file);
  if (!mesh) return mesh.error();
  const float metres = unit == "mm" ? 0.001f : unit == "cm" ? 0.01f : 1.0f;
  for (Vec3& p : mesh->positions) p = metres * p;
  Result<Character> result(Character{file.stem().string(), {}, {}});
  result.warnings = std::move(mesh.warnings);
  const float extent = largest_extent(*mesh);
  if (!(extent > kSmallestHead && extent < kLargestHead))
    result.warnings.push_back("the mesh is " + fixed(extent, 4) + " m large: is --unit " + unit + " right?");
  mesh->normals.clear();
  result->parts.push_back({"skin", std::move(*mesh), {}});
  return result;
}

Result<std::vector<Marker>> read_markers(const MarkerFiles& files, const Character& source,
                                         const Character& target) {
  std::vector<Marker> markers;
  if (!files.pairs.empty()) {
    MIEN_TRY(const Bytes bytes, read_file(files.pairs));
    const auto pairs = read_index_pairs(as_text(bytes));
    if (!pairs) return within(pairs.error(), "'" + files.pairs + "'");
    for (const auto& [s, t] : *pairs) markers.push_back({s, t});
    return markers;
  }
  MIEN_TRY(const auto from, landmarks_of(files.source_landmarks, source, "--source-landmarks"));
  MIEN_TRY(const auto to, landmarks_of(files.target_landmarks, target, "--target-landmarks"));
  if (from.size() != to.size())
    return Error{
        Errc::input, "landmarks",
        "the source has " + std::to_string(from.size()) + ", the target " + std::to_string(to.size()),
        "Both lists must name the same places in the same order"};
  for (std::size_t i = 0; i < from.size(); ++i) markers.push_back({from[i], to[i]});
  return markers;
}

Result<std::vector<bool>> read_exclusions(const std::vector<std::string>& words, const Character& character) {
  const std::size_t count = num_vertices(character);
  std::vector<bool> excluded(count);
  for (const auto& word : words) {
    if (word == "islands") {
      const auto number = components(count, merged_mesh(character).triangles);
      std::vector<std::size_t> sizes(count);
      for (const auto n : number) ++sizes[n];
      const auto largest =
          static_cast<std::uint32_t>(std::max_element(sizes.begin(), sizes.end()) - sizes.begin());
      for (std::size_t v = 0; v < count; ++v)
        if (number[v] != largest) excluded[v] = true;
      continue;
    }
    std::size_t first = 0;
    bool is_part = false;
    for (const auto& part : character.parts) {
      if (part.name == word) {
        std::fill_n(excluded.begin() + static_cast<std::ptrdiff_t>(first), part.mesh.positions.size(), true);
        is_part = true;
      }
      first += part.mesh.positions.size();
    }
    if (is_part) continue;
    std::string text = word;
    std::error_code problem;
    if (fs::is_regular_file(word, problem)) {
      MIEN_TRY(const Bytes bytes, read_file(word));
      text = as_text(bytes);
    }
    const auto list = read_index_list(text, count);
    if (!list) return within(list.error(), "--exclude '" + word + "'");
    for (const auto v : *list) excluded[v] = true;
  }
  return excluded;
}

}  // namespace mien
