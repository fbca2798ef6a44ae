#include "person_faces.h"

#include <vector>

#include "mien/base/file.h"
#include "mien/io/index_list.h"

namespace mien {
namespace {

std::vector<float> taken(const std::vector<float>& all, const std::vector<std::uint32_t>& vertices) {
  std::vector<float> values;
  values.reserve(3 * vertices.size());
  for (const std::size_t v : vertices)
    for (std::size_t c = 0; c < 3; ++c) values.push_back(all[3 * v + c]);
  return values;
}

std::vector<Vec3> points_of(const std::vector<float>& values) {
  std::vector<Vec3> points;
  points.reserve(values.size() / 3);
  for (std::size_t i = 0; i + 2 < values.size(); i += 3)
    points.push_back({values[i], values[i + 1], values[i + 2]});
  return points;
}

}  // namespace

Result<PersonFaces> PersonFaces::load(const std::string& residuals, const std::string& templates,
                                      const std::string& subset) {
  PersonFaces faces;
  MIEN_TRY(faces.residuals_, load_blendshape_residuals(residuals));
  MIEN_TRY(const Templates whole, load_templates(templates));
  const std::size_t num_whole = whole.begin()->second.size() / 3;
  const std::size_t num_moved = faces.residuals_.begin()->second.begin()->second.size() / 3;
  std::vector<std::uint32_t> kept;
  if (!subset.empty()) {
    MIEN_TRY(const Bytes bytes, read_file(subset));
    auto list = read_index_list(as_text(bytes), num_whole);
    if (!list) return within(list.error(), "--vertices '" + subset + "'");
    kept = std::move(*list);
  }
  const bool is_cropped = !kept.empty() && kept.size() == num_moved;
  if (!is_cropped && num_whole != num_moved)
    return Error{Errc::incompatible, "'" + residuals + "'",
                 "moves " + std::to_string(num_moved) + " vertices, the templates have " +
                     std::to_string(num_whole) +
                     (subset.empty() ? "" : ", --vertices names " + std::to_string(kept.size())),
                 "Name the vertices that it moves: --vertices FLAME_head_idx.txt"};
  for (const auto& [person, shapes] : faces.residuals_) {
    const auto found = whole.find(person);
    if (found == whole.end())
      return Error{Errc::incompatible, "'" + templates + "'", "has no template of '" + person + "'", ""};
    faces.neutral_[person] = is_cropped ? taken(found->second, kept) : found->second;
  }
  return faces;
}

Result<std::string> PersonFaces::person_of(const std::filesystem::path& sequence) const {
  const std::string name = sequence.stem().string(), folder = sequence.parent_path().filename().string();
  std::string best;  // of persons that begin alike, the longest
  for (const auto& [person, shapes] : residuals_)
    if ((name == person || name.starts_with(person + "_") || folder == person) && person.size() > best.size())
      best = person;
  if (!best.empty()) return best;
  return Error{Errc::incompatible, "'" + sequence.string() + "'",
               "is of none of the " + std::to_string(residuals_.size()) + " persons with shapes",
               "Expected are names like " + residuals_.begin()->first + "_sentence01"};
}

Character PersonFaces::face(const std::string& person) const {
  CharacterPart part{"skin", {}, {}};
  part.mesh.positions = points_of(neutral_.at(person));
  for (const auto& [name, offsets] : residuals_.at(person)) {
    Blendshape shape{name, {}, {}, {}};
    shape.offsets = points_of(offsets);
    for (std::uint32_t v = 0; v < shape.offsets.size(); ++v) shape.vertices.push_back(v);
    part.shapes.push_back(std::move(shape));
  }
  return Character{person, {std::move(part)}, {}};
}

}  // namespace mien
