#include "blendshape_folder.h"

#include <algorithm>
#include <cctype>

#include "csv_text.h"
#include "mien/base/file.h"
#include "mien/core/arkit.h"
#include "mien/io/file_extension.h"
#include "mien/io/mesh_file.h"
#include "shape_names.h"

namespace mien::io {
namespace {

namespace fs = std::filesystem;

Result<Mesh> read_mesh(const fs::path& path) {
  MIEN_TRY(const Bytes bytes, read_file(path));
  auto mesh = lower_extension(path) == ".ply" ? read_ply(bytes) : read_obj(as_text(bytes));
  if (!mesh) return within(mesh.error(), "'" + path.string() + "'");
  return mesh;
}

Blendshape shape_between(const std::string& name, const Mesh& neutral, const Mesh& moved) {
  Blendshape shape{name, {}, {}, {}};
  for (std::uint32_t v = 0; v < neutral.positions.size(); ++v) {
    const Vec3 offset = moved.positions[v] - neutral.positions[v];
    if (offset == Vec3{}) continue;
    shape.vertices.push_back(v);
    shape.offsets.push_back(offset);
  }
  return shape;
}

}  // namespace

Result<Character> read_blendshape_folder(const fs::path& folder) {
  const std::string what = "folder '" + folder.string() + "'";
  std::vector<fs::path> files;
  fs::path neutral_file;
  std::error_code problem;
  for (const auto& entry : fs::directory_iterator(folder, problem)) {
    const std::string extension = lower_extension(entry.path());
    if (extension != ".obj" && extension != ".ply") continue;
    if (lower(entry.path().stem().string()) == "neutral")
      neutral_file = entry.path();
    else
      files.push_back(entry.path());
  }
  if (problem) return Error{Errc::input, what, "cannot be read: " + problem.message(), ""};
  if (neutral_file.empty())
    return Error{Errc::input, what, "holds no neutral.obj or neutral.ply",
                 "Name the face at rest so; every other mesh is a shape of its name"};
  std::sort(files.begin(), files.end());
  MIEN_TRY(const Mesh neutral, read_mesh(neutral_file));
  if (neutral.positions.empty())
    return Error{Errc::input, "'" + neutral_file.string() + "'", "has no vertices", ""};
  std::vector<std::string> names;
  for (const auto& file : files) names.push_back(file.stem().string());
  const auto matched = arkit_of(names);
  CharacterPart part{"skin", neutral, {}};
  Result<Character> result{Character{}};
  std::vector<std::string> unmatched;
  for (std::size_t i = 0; i < files.size(); ++i) {
    MIEN_TRY(const Mesh moved, read_mesh(files[i]));
    if (moved.positions.size() != neutral.positions.size())
      return Error{Errc::incompatible, "'" + files[i].string() + "'",
                   "has " + std::to_string(moved.positions.size()) + " vertices, the neutral face " +
                       std::to_string(neutral.positions.size()),
                   "All meshes of the folder must have the same vertices in the same order"};
    if (!matched[i]) unmatched.push_back(names[i]);
    part.shapes.push_back(shape_between(matched[i].value_or(names[i]), neutral, moved));
  }
  if (!unmatched.empty()) result.warnings.push_back("shapes without an ARKit name: " + listed(unmatched));
  const auto rank = [](const Blendshape& shape) {
    const auto all = arkit_names();
    return std::find(all.begin(), all.end(), shape.name) - all.begin();
  };
  std::stable_sort(part.shapes.begin(), part.shapes.end(),
                   [&](const Blendshape& a, const Blendshape& b) { return rank(a) < rank(b); });
  result->name =
      folder.filename().empty() ? folder.parent_path().filename().string() : folder.filename().string();
  result->parts.push_back(std::move(part));
  return result;
}

}  // namespace mien::io
