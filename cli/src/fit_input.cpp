#include "fit_input.h"

#include <algorithm>
#include <cctype>
#include <limits>

#include "mien/base/file.h"
#include "mien/core/arkit.h"
#include "mien/io/index_list.h"
#include "mien/io/mesh_file.h"
#include "mien/io/motion_file.h"
#include "mien/io/vl.h"
#include "nearest_name.h"

namespace mien {
namespace {

namespace fs = std::filesystem;

std::string lower_extension(const fs::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension;
}

bool is_frame(const fs::path& path) {
  const std::string extension = lower_extension(path);
  return extension == ".obj" || extension == ".ply" || extension == ".vl";
}

std::vector<fs::path> sorted_entries(const fs::path& folder) {
  std::vector<fs::path> entries;
  std::error_code problem;
  for (const auto& entry : fs::directory_iterator(folder, problem)) entries.push_back(entry.path());
  std::sort(entries.begin(), entries.end());
  return entries;
}

std::vector<fs::path> frames_of(const fs::path& folder) {
  std::vector<fs::path> frames = sorted_entries(folder);
  std::erase_if(frames, [](const fs::path& path) { return !is_frame(path) || fs::is_directory(path); });
  return frames;
}

Result<std::vector<Vec3>> read_frame(const fs::path& path) {
  if (lower_extension(path) != ".vl") {
    MIEN_TRY(auto mesh, load_mesh(path));
    return std::move(mesh.positions);
  }
  MIEN_TRY(const Bytes bytes, read_file(path));
  auto positions = read_vl(bytes);
  if (!positions) return within(positions.error(), "'" + path.string() + "'");
  return positions;
}

Result<Motion> read_frames(const fs::path& folder, double fps) {
  Motion motion;
  for (const fs::path& path : frames_of(folder)) {
    MIEN_TRY(const auto positions, read_frame(path));
    const auto count = static_cast<std::int64_t>(positions.size());
    if (motion.topology.num_vertices == 0) {
      const auto known = known_topology(count);
      motion = vertex_motion(topology_of(count), fps > 0 ? fps : known ? known->fps : 30);
    }
    if (count != motion.topology.num_vertices)
      return Error{Errc::incompatible, "'" + path.string() + "'",
                   "has " + std::to_string(count) + " vertices, the frames before it " +
                       std::to_string(motion.topology.num_vertices),
                   "A folder holds the frames of one sequence"};
    for (const Vec3& p : positions) motion.values.insert(motion.values.end(), {p.x, p.y, p.z});
  }
  return motion;
}

Result<std::vector<Blendshape>> chosen_shapes(std::vector<Blendshape> all, const std::string& names) {
  if (names.empty()) return all;
  std::vector<std::string> wanted, known;
  if (names == "said") wanted = arkit_order(ArkitOrder::said);
  for (std::size_t first = 0; names != "said" && first <= names.size();) {
    const std::size_t end = std::min(names.find(',', first), names.size());
    if (end > first) wanted.push_back(names.substr(first, end - first));
    first = end + 1;
  }
  for (const auto& shape : all) known.push_back(shape.name);
  std::vector<Blendshape> chosen;
  for (const auto& name : wanted) {
    const auto found = std::find_if(all.begin(), all.end(), [&](const auto& s) { return s.name == name; });
    if (found == all.end()) {
      const std::string near = nearest_name(name, known);
      return Error{Errc::usage, "shape '" + name + "'",
                   "is not one of the character's " + std::to_string(all.size()),
                   near.empty() ? "`mien inspect` lists them" : "Did you mean " + near + "?"};
    }
    if (std::none_of(chosen.begin(), chosen.end(), [&](const auto& s) { return s.name == name; }))
      chosen.push_back(*found);
  }
  return chosen;
}

// Keeps the listed vertices, in the order of the list.
void crop(FitRig& rig, const std::vector<std::uint32_t>& kept) {
  constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> place(rig.neutral.size(), kNone);
  std::vector<Vec3> neutral;
  for (std::uint32_t i = 0; i < kept.size(); ++i) {
    place[kept[i]] = i;
    neutral.push_back(rig.neutral[kept[i]]);
  }
  for (Blendshape& shape : rig.shapes) {
    std::vector<std::pair<std::uint32_t, Vec3>> moved;
    for (std::size_t m = 0; m < shape.vertices.size(); ++m)
      if (const auto to = place[shape.vertices[m]]; to != kNone) moved.emplace_back(to, shape.offsets[m]);
    std::sort(moved.begin(), moved.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    shape = Blendshape{shape.name, {}, {}, {}};
    for (const auto& [v, offset] : moved) {
      shape.vertices.push_back(v);
      shape.offsets.push_back(offset);
    }
  }
  for (auto& [name, vertices] : rig.regions) {
    std::vector<std::uint32_t> within;
    for (const auto v : vertices)
      if (place[v] != kNone) within.push_back(place[v]);
    vertices = std::move(within);
  }
  rig.neutral = std::move(neutral);
}

}  // namespace

Result<std::vector<fs::path>> find_sequences(const std::string& path) {
  std::error_code problem;
  if (!fs::is_directory(path, problem)) return std::vector<fs::path>{path};
  fs::path folder(path);
  if (folder.filename().empty()) folder = folder.parent_path();
  if (!frames_of(folder).empty()) return std::vector<fs::path>{folder};
  if (fs::exists(folder / "data_verts.npy", problem))
    return Error{Errc::incompatible, "folder '" + path + "'",
                 "is VOCASET as released: one table holds the frames of all sequences",
                 "Take them apart: mien data prepare " + path +
                     " --layout vocaset -o vocaset; then fit "
                     "vocaset/vertices_npy"};
  std::vector<fs::path> found;
  for (const fs::path& entry : sorted_entries(folder))
    if (lower_extension(entry) == ".npy" || (fs::is_directory(entry, problem) && !frames_of(entry).empty()))
      found.push_back(entry);
  if (found.empty())
    return Error{Errc::input, "folder '" + path + "'", "holds no sequence of vertices",
                 "Expected .npy files, or folders of .obj, .ply or .vl frames"};
  return found;
}

Result<Motion> read_sequence(const fs::path& path, double fps) {
  std::error_code problem;
  if (fs::is_directory(path, problem)) return read_frames(path, fps);
  auto motion = read_motion(path, {.fps = fps});
  if (motion && motion->space != MotionSpace::vertices)
    return Error{Errc::incompatible, "'" + path.string() + "'", "is not motion of vertices",
                 "Expected an array [frames, 3 vertices] or [frames, vertices, 3]"};
  return motion;
}

Result<FitRig> fit_rig(const Character& character, const std::string& names, const std::string& subset,
                       std::int64_t sequence_vertices) {
  FitRig rig{merged_mesh(character).positions, {}, character.regions, {}};
  rig.regions.erase("landmarks68");
  MIEN_TRY(rig.shapes, chosen_shapes(merged_shapes(character), names));
  if (rig.shapes.empty())
    return Error{Errc::incompatible, "character '" + character.name + "'", "has no shapes to fit", ""};
  if (subset.empty()) return rig;
  MIEN_TRY(const Bytes bytes, read_file(subset));
  const auto list = read_index_list(as_text(bytes), static_cast<std::size_t>(sequence_vertices));
  if (!list) return within(list.error(), "--vertices '" + subset + "'");
  std::vector<bool> seen(static_cast<std::size_t>(sequence_vertices));
  for (const auto v : *list) {
    if (seen[v])
      return Error{Errc::input, "--vertices '" + subset + "'", "names vertex " + std::to_string(v) + " twice",
                   ""};
    seen[v] = true;
  }
  rig.taken = *list;
  if (rig.neutral.size() == list->size()) return rig;
  if (static_cast<std::int64_t>(rig.neutral.size()) != sequence_vertices)
    return Error{Errc::incompatible, "--vertices '" + subset + "'",
                 "names " + std::to_string(list->size()) + " vertices of " +
                     std::to_string(sequence_vertices) + ", the character has " +
                     std::to_string(rig.neutral.size()),
                 "The character must have all vertices of the sequence, or just those of the list"};
  crop(rig, *list);
  return rig;
}

Motion taken_vertices(const FitRig& rig, Motion sequence) {
  if (rig.taken.empty()) return sequence;
  Motion part =
      vertex_motion({sequence.topology.name, static_cast<std::int64_t>(rig.taken.size())}, sequence.fps);
  part.values.reserve(static_cast<std::size_t>(sequence.num_frames()) * 3 * rig.taken.size());
  for (std::int64_t n = 0; n < sequence.num_frames(); ++n) {
    const auto frame = sequence.frame(n);
    for (const auto v : rig.taken)
      part.values.insert(part.values.end(), frame.begin() + 3 * v, frame.begin() + 3 * v + 3);
  }
  return part;
}

}  // namespace mien
