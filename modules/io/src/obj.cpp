#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "mien/base/number_text.h"
#include "mien/io/mesh_file.h"
#include "polygon.h"

namespace mien {
namespace {

constexpr std::string_view kBlanks = " \t\r";
// Keywords of the format that say nothing about positions and triangles.
constexpr std::string_view kIgnored[] = {"vt", "vn", "vp", "g", "o", "s", "usemtl", "mtllib", "l", "p", "mg"};

// The next word of a line, or an empty one at its end.
std::string_view next_word(std::string_view& line) {
  const auto start = std::min(line.find_first_not_of(kBlanks), line.size());
  line.remove_prefix(start);
  const auto end = std::min(line.find_first_of(kBlanks), line.size());
  const auto word = line.substr(0, end);
  line.remove_prefix(end);
  return word;
}

std::optional<float> next_coordinate(std::string_view& line) {
  const auto value = parse_double(next_word(line));
  if (!value || !std::isfinite(static_cast<float>(*value))) return std::nullopt;
  return static_cast<float>(*value);
}

// "7/1/3" or "-1": the vertex of a corner, counted from 0.
std::optional<std::uint32_t> corner(std::string_view word, std::size_t num_vertices) {
  const auto index = parse_int(word.substr(0, std::min(word.find('/'), word.size())));
  if (!index || *index == 0) return std::nullopt;
  const std::int64_t v = *index > 0 ? *index - 1 : static_cast<std::int64_t>(num_vertices) + *index;
  if (v < 0 || v > 0xffffffffll) return std::nullopt;
  return static_cast<std::uint32_t>(v);
}

}  // namespace

Result<Mesh> read_obj(std::string_view text) {
  Mesh mesh;
  std::set<std::string> unknown;
  std::vector<std::uint32_t> corners;
  std::size_t line_number = 0;
  const auto bad = [&](std::string_view why) {
    return Error{Errc::input, "OBJ file", "line " + std::to_string(line_number) + ": " + std::string(why),
                 ""};
  };
  while (!text.empty()) {
    ++line_number;
    const auto end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    const auto keyword = next_word(line);
    if (keyword.empty() || keyword.front() == '#') continue;
    if (keyword == "v") {
      const auto x = next_coordinate(line), y = next_coordinate(line), z = next_coordinate(line);
      if (!x || !y || !z) return bad("a vertex needs three finite numbers");
      mesh.positions.push_back({*x, *y, *z});
    } else if (keyword == "f") {
      corners.clear();
      for (auto word = next_word(line); !word.empty() && word.front() != '#'; word = next_word(line)) {
        const auto v = corner(word, mesh.positions.size());
        if (!v) return bad("'" + std::string(word) + "' is no vertex of a face");
        corners.push_back(*v);
      }
      if (corners.size() < 3) return bad("a face needs three corners or more");
      io::add_fan(corners, mesh.triangles);
    } else if (std::find(std::begin(kIgnored), std::end(kIgnored), keyword) == std::end(kIgnored)) {
      unknown.insert(std::string(keyword.substr(0, 40)));
    }
  }
  if (const auto stray = io::stray_vertex(mesh))  // faces may come before the vertices they name
    return Error{
        Errc::input, "OBJ file",
        "a face names vertex " + std::to_string(*stray + 1) + " of " + std::to_string(mesh.positions.size()),
        ""};
  Result<Mesh> result(std::move(mesh));
  for (const auto& keyword : unknown) result.warnings.push_back("lines with '" + keyword + "' are left out");
  return result;
}

std::string write_obj(const Mesh& mesh) {
  std::string text;
  for (const Vec3& p : mesh.positions)
    text += "v " + shortest(p.x) + " " + shortest(p.y) + " " + shortest(p.z) + "\n";
  for (const auto& t : mesh.triangles)
    text += "f " + std::to_string(t[0] + 1) + " " + std::to_string(t[1] + 1) + " " +
            std::to_string(t[2] + 1) + "\n";
  return text;
}

}  // namespace mien
