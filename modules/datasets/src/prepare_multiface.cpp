#include <algorithm>
#include <map>
#include <optional>

#include "mien/audio/load_audio.h"
#include "mien/base/file.h"
#include "mien/base/number_text.h"
#include "mien/datasets/prepared_files.h"
#include "mien/datasets/scaling.h"
#include "mien/datasets/templates.h"
#include "mien/io/mesh_file.h"
#include "preparers.h"

namespace mien::datasets {
namespace {

namespace fs = std::filesystem;
constexpr float kGain = 10;  // 20 dB: the thesis; the published script leaves the sound to the user

struct Raw {
  std::map<std::string, std::map<std::int64_t, fs::path>> frames;  // by sequence and number
  std::map<std::string, fs::path> sounds;
};

// "2_46", or "46" in a folder "2".
std::optional<std::string> sequence_of(const fs::path& path) {
  const std::string own = path.stem().string(), above = path.parent_path().filename().string();
  for (const std::string& name : {own, above + "_" + own})
    if (parse_sequence_name(DatasetKind::multiface, name)) return name;
  return std::nullopt;
}

Result<Raw> list_raw(const fs::path& folder) {
  std::error_code ec;
  fs::recursive_directory_iterator entries(folder, ec);
  if (ec) return Error{Errc::input, "'" + folder.string() + "'", "cannot be listed: " + ec.message(), ""};
  Raw raw;
  for (const auto& entry : entries) {
    const fs::path& path = entry.path();
    if (path.extension() == ".wav") {
      if (const auto name = sequence_of(path)) raw.sounds[*name] = path;
    } else if (path.extension() == ".obj" || path.extension() == ".ply") {
      const auto name = sequence_of(path.parent_path());
      const auto number = frame_number(path.stem().string());
      if (!name || !number) continue;  // a template, perhaps
      if (!raw.frames[*name].emplace(*number, path).second)
        return Error{Errc::input, "'" + path.string() + "'",
                     "is another frame " + std::to_string(*number) + " of its sequence", ""};
    }
  }
  if (raw.frames.empty())
    return Error{Errc::input, "'" + folder.string() + "'", "holds no meshes of a subject and a sentence",
                 "Expected folders such as 2_46 or 2/46 with 000001.obj ..."};
  return raw;
}

// Numbers of the vertices to leave out, ascending.
Result<std::vector<std::size_t>> read_dropped(const fs::path& path) {
  std::vector<std::size_t> dropped;
  if (path.empty()) return dropped;
  MIEN_TRY(const Bytes bytes, read_file(path));
  const std::string_view text = as_text(bytes);
  constexpr std::string_view kBetween = ", \t\r\n";
  for (std::size_t at = text.find_first_not_of(kBetween); at != text.npos;
       at = text.find_first_not_of(kBetween, at)) {
    const std::size_t end = std::min(text.find_first_of(kBetween, at), text.size());
    const auto number = parse_int(text.substr(at, end - at));
    if (!number || *number < 0)
      return Error{Errc::input, "'" + path.string() + "'",
                   "'" + std::string(text.substr(at, std::min<std::size_t>(end - at, 20))) + "' is no vertex",
                   ""};
    dropped.push_back(static_cast<std::size_t>(*number));
    at = end;
  }
  std::ranges::sort(dropped);
  dropped.erase(std::unique(dropped.begin(), dropped.end()), dropped.end());
  return dropped;
}

// Positions without the dropped vertices, scaled.
Result<std::vector<float>> reduced(const std::vector<float>& positions,
                                   const std::vector<std::size_t>& dropped, const std::string& name) {
  if (!dropped.empty() && dropped.back() >= positions.size() / 3)
    return Error{Errc::incompatible, name,
                 "has " + std::to_string(positions.size() / 3) + " vertices, vertex " +
                     std::to_string(dropped.back()) + " is to be left out",
                 ""};
  std::vector<float> kept;
  auto next = dropped.begin();
  for (std::size_t v = 0; v < positions.size() / 3; ++v) {
    if (next != dropped.end() && *next == v) {
      ++next;
      continue;
    }
    kept.insert(kept.end(), {positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]});
  }
  apply_scale(multiface_scale(), kept);
  return kept;
}

std::vector<float> positions_of(const Mesh& mesh) {
  std::vector<float> values;
  for (const Vec3& p : mesh.positions) values.insert(values.end(), {p.x, p.y, p.z});
  return values;
}

}  // namespace

Result<PrepareReport> prepare_multiface(const fs::path& raw, const fs::path& out,
                                        const PrepareOptions& options, Progress& progress) {
  if (options.templates.empty())
    return Error{Errc::usage, "multiface", "needs the subjects' neutral meshes",
                 "Pass --templates with templates.pkl or a folder of <subject>.obj, unscaled"};
  MIEN_TRY(const auto dropped, read_dropped(options.drop_vertices));
  MIEN_TRY(Templates templates, load_templates(options.templates));
  for (auto& [subject, neutral] : templates) {
    MIEN_TRY(neutral, reduced(neutral, dropped, "template '" + subject + "'"));
  }
  const std::size_t width = templates.begin()->second.size();
  MIEN_TRY(const Raw found, list_raw(raw));
  MIEN_TRY([[maybe_unused]] const auto made, make_folders(out));
  Result<PrepareReport> result{PrepareReport{}};
  progress.stage("sequences", static_cast<std::int64_t>(found.frames.size()));
  std::int64_t done = 0;
  for (const auto& [name, frames] : found.frames) {
    progress.update(++done);
    const auto sound = found.sounds.find(name);
    const bool is_known = templates.contains(parse_sequence_name(DatasetKind::multiface, name)->subject);
    if (sound == found.sounds.end() || !is_known) {
      result.warnings.push_back(name +
                                " is left out: " + (is_known ? "no sound" : "no template of its subject"));
      continue;
    }
    NpyArray motion{{static_cast<std::int64_t>(frames.size()), static_cast<std::int64_t>(width)}, {}};
    for (const auto& [number, path] : frames) {
      if (progress.cancelled()) return Error{Errc::cancelled, "", "interrupted", ""};
      MIEN_TRY(const Mesh mesh, load_mesh(path));
      MIEN_TRY(const auto values, reduced(positions_of(mesh), dropped, "'" + path.string() + "'"));
      if (values.size() != width)
        return Error{
            Errc::incompatible, "'" + path.string() + "'",
            "has " + std::to_string(values.size() / 3) + " vertices, the templates " +
                std::to_string(width / 3),
            "The published models use 6172: name the vertices that they leave out with --drop-vertices"};
      motion.values.insert(motion.values.end(), values.begin(), values.end());
    }
    MIEN_TRY(AudioClip clip, load_audio(sound->second));
    for (float& sample : clip.samples) sample *= kGain;
    MIEN_TRY([[maybe_unused]] const auto written, write_motion_array(out, name, motion));
    MIEN_TRY([[maybe_unused]] const auto heard, write_sound(out, name, clip));
    ++result->num_sequences;
    result->num_frames += motion.shape[0];
  }
  if (result->num_sequences == 0)
    return Error{Errc::input, "'" + raw.string() + "'", "no sequence has meshes, sound and a template", ""};
  MIEN_TRY([[maybe_unused]] const auto kept, write_templates(out / "templates.safetensors", templates));
  return result;
}

}  // namespace mien::datasets
