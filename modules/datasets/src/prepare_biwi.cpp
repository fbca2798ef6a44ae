#include <algorithm>
#include <map>
#include <optional>

#include "mien/base/file.h"
#include "mien/base/number_text.h"
#include "mien/datasets/prepared_files.h"
#include "mien/datasets/scaling.h"
#include "mien/datasets/templates.h"
#include "mien/io/mesh_file.h"
#include "mien/io/vl.h"
#include "preparers.h"

namespace mien::datasets {
namespace {

namespace fs = std::filesystem;

// "e07" or "07": a sentence, and whether it is the emotional reading.
struct Reading {
  int sentence = 0;
  bool emotional = false;
};

std::optional<Reading> parse_reading(std::string_view text) {
  Reading reading;
  reading.emotional = text.starts_with('e');
  if (reading.emotional) text.remove_prefix(1);
  const auto sentence = parse_int(text);
  if (!sentence || *sentence < 1 || *sentence > 40) return std::nullopt;
  reading.sentence = static_cast<int>(*sentence);
  return reading;
}

bool is_subject(std::string_view text) {
  return text.size() == 2 && (text[0] == 'F' || text[0] == 'M') && text[1] >= '1' && text[1] <= '9';
}

struct Recording {
  std::string subject;
  Reading reading;
  std::map<std::int64_t, fs::path> frames;  // by number
};

std::string two_digits(int n) { return (n < 10 ? "0" : "") + std::to_string(n); }

// The name under which the sound lies: "F1_e07".
std::string raw_name(const Recording& r) {
  return r.subject + "_" + (r.reading.emotional ? "e" : "") + two_digits(r.reading.sentence);
}

struct Raw {
  std::map<std::string, Recording> recordings;  // by raw name
  std::map<std::string, fs::path> sounds;       // by raw name
  std::vector<std::string> warnings;
};

// "F1/e07/frame_001.vl" and "F1_e07/frame_001.vl".
std::optional<Recording> recording_of(const fs::path& folder) {
  const std::string own = folder.filename().string(), above = folder.parent_path().filename().string();
  const auto cut = own.find('_');
  const std::string subject = cut == std::string::npos ? above : own.substr(0, cut);
  const auto reading = parse_reading(cut == std::string::npos ? own : own.substr(cut + 1));
  if (!reading || !is_subject(subject)) return std::nullopt;
  return Recording{subject, *reading, {}};
}

// "F1_e07_cut.wav", "F1_e07.wav", "F1/e07_cut.wav"; the cut one is preferred.
void add_sound(const fs::path& path, Raw& raw) {
  std::string stem = path.stem().string();
  const bool is_cut = stem.ends_with("_cut");
  if (is_cut) stem.resize(stem.size() - 4);
  const auto cut = stem.find('_');
  const std::string subject =
      cut == std::string::npos ? path.parent_path().filename().string() : stem.substr(0, cut);
  const auto reading = parse_reading(cut == std::string::npos ? stem : stem.substr(cut + 1));
  if (!reading || !is_subject(subject)) return;
  fs::path& place = raw.sounds[raw_name({subject, *reading, {}})];
  if (place.empty() || is_cut) place = path;
}

Result<Raw> list_raw(const fs::path& folder) {
  std::error_code ec;
  Raw raw;
  std::map<std::string, int> strangers;
  fs::recursive_directory_iterator entries(folder, ec);
  if (ec) return Error{Errc::input, "'" + folder.string() + "'", "cannot be listed: " + ec.message(), ""};
  for (const auto& entry : entries) {
    const fs::path& path = entry.path();
    if (path.extension() == ".wav") add_sound(path, raw);
    if (path.extension() != ".vl") continue;
    auto recording = recording_of(path.parent_path());
    const auto number = frame_number(path.stem().string());
    if (!recording || !number) {
      ++strangers[path.parent_path().string()];
      continue;
    }
    auto& place = raw.recordings.try_emplace(raw_name(*recording), *recording).first->second;
    if (!place.frames.emplace(*number, path).second)
      return Error{Errc::input, "'" + path.string() + "'",
                   "is another frame " + std::to_string(*number) + " of its sequence", ""};
  }
  for (const auto& [place, count] : strangers)
    raw.warnings.push_back("'" + place + "': " + std::to_string(count) +
                           " frames are of no subject and sentence");
  if (raw.recordings.empty())
    return Error{Errc::input, "'" + folder.string() + "'", "holds no .vl frames of a subject and a sentence",
                 "Expected folders such as F1/e01 with frame_001.vl ..."};
  return raw;
}

// [N, 3 V] of one recording, unscaled.
Result<NpyArray> read_frames(const Recording& recording, std::optional<std::size_t>& num_vertices) {
  NpyArray motion;
  for (const auto& [number, path] : recording.frames) {
    MIEN_TRY(const Bytes bytes, read_file(path));
    const auto frame = read_vl(bytes);
    if (!frame) return within(frame.error(), "'" + path.string() + "'");
    if (!num_vertices) num_vertices = frame->size();
    if (frame->size() != *num_vertices || frame->empty())
      return Error{Errc::incompatible, "'" + path.string() + "'",
                   "has " + std::to_string(frame->size()) + " vertices, the frames before it " +
                       std::to_string(*num_vertices),
                   ""};
    for (const Vec3& p : *frame) motion.values.insert(motion.values.end(), {p.x, p.y, p.z});
  }
  motion.shape = {static_cast<std::int64_t>(recording.frames.size()),
                  static_cast<std::int64_t>(3 * *num_vertices)};
  return motion;
}

// What a kind does to the meshes of a recording.
class MeshScaler {
 public:
  static Result<MeshScaler> create(DatasetKind kind, const PrepareOptions& options) {
    MeshScaler scaler;
    scaler.kind_ = kind;
    if (kind == DatasetKind::biwi) {
      MIEN_TRY(scaler.mesh_, load_mesh(options.mesh));
      return scaler;
    }
    MIEN_TRY(scaler.templates_, load_templates(options.templates));
    for (auto& [subject, neutral] : scaler.templates_) {
      const auto scale = box_scale(neutral);
      if (!scale) return within(scale.error(), "subject '" + subject + "'");
      scaler.scales_[subject] = *scale;
      apply_scale(*scale, neutral);
    }
    return scaler;
  }

  [[nodiscard]] bool knows(const std::string& subject) const {
    return kind_ == DatasetKind::biwi || scales_.contains(subject);
  }

  Status apply(const Recording& recording, NpyArray& motion) const {
    const auto width = static_cast<std::size_t>(motion.shape[1]);
    const std::size_t expected =
        kind_ == DatasetKind::biwi ? 3 * mesh_.positions.size() : templates_.at(recording.subject).size();
    if (width != expected)
      return Error{Errc::incompatible, "sequence '" + raw_name(recording) + "'",
                   "has " + std::to_string(width / 3) + " vertices, the " +
                       (kind_ == DatasetKind::biwi ? "mesh " : "template ") + std::to_string(expected / 3),
                   ""};
    if (kind_ != DatasetKind::biwi) {
      apply_scale(scales_.at(recording.subject), motion.values);
      return Done{};
    }
    for (std::size_t at = 0; at < motion.values.size(); at += width) {
      const auto scaled = scale_by_area(mesh_.triangles, std::span(motion.values).subspan(at, width));
      if (!scaled) return within(scaled.error(), "sequence '" + raw_name(recording) + "'");
    }
    return Done{};
  }

  /// The templates in the scale of the motion.
  Result<Templates> templates(const PrepareOptions& options) const {
    if (kind_ != DatasetKind::biwi || options.templates.empty()) return templates_;
    MIEN_TRY(Templates all, load_templates(options.templates));
    for (auto& [subject, neutral] : all) {
      if (neutral.size() != 3 * mesh_.positions.size())
        return Error{Errc::incompatible, "template '" + subject + "'",
                     "has another number of vertices than the mesh", ""};
      MIEN_TRY([[maybe_unused]] const auto scaled, scale_by_area(mesh_.triangles, neutral));
    }
    return all;
  }

 private:
  DatasetKind kind_ = DatasetKind::biwi;
  Mesh mesh_;
  Templates templates_;
  std::map<std::string, AxisScale> scales_;
};

}  // namespace

Result<PrepareReport> prepare_biwi(DatasetKind kind, const fs::path& raw, const fs::path& out,
                                   const PrepareOptions& options, Progress& progress) {
  const bool expressive = kind == DatasetKind::biwi_expressive;
  if (expressive ? options.templates.empty() : options.mesh.empty())
    return Error{Errc::usage, std::string(dataset_layout(kind).name),
                 expressive ? "needs the unscaled templates" : "needs a mesh with the triangles",
                 expressive ? "Pass --templates templates_orig.pkl" : "Pass --mesh with a template (.obj)"};
  MIEN_TRY(const MeshScaler scaler, MeshScaler::create(kind, options));
  MIEN_TRY(const Raw found, list_raw(raw));
  MIEN_TRY([[maybe_unused]] const auto made, make_folders(out));
  Result<PrepareReport> result{PrepareReport{}};
  result.warnings = found.warnings;
  progress.stage("sequences", static_cast<std::int64_t>(found.recordings.size()));
  std::optional<std::size_t> num_vertices;
  std::int64_t done = 0;
  for (const auto& [name, recording] : found.recordings) {
    if (progress.cancelled()) return Error{Errc::cancelled, "", "interrupted", ""};
    progress.update(++done);
    const auto sound = found.sounds.find(name);
    if (!expressive && !recording.reading.emotional)
      continue;  // FaceDiffuser uses the emotional readings alone
    if (sound == found.sounds.end() || !scaler.knows(recording.subject)) {
      result.warnings.push_back(name + " is left out: " +
                                (sound == found.sounds.end() ? "no sound" : "no template of its subject"));
      continue;
    }
    MIEN_TRY(NpyArray motion, read_frames(recording, num_vertices));
    MIEN_TRY([[maybe_unused]] const auto scaled, scaler.apply(recording, motion));
    const int number = recording.reading.sentence + (expressive && recording.reading.emotional ? 40 : 0);
    const std::string own = expressive ? recording.subject + "_" + two_digits(number) : name;
    MIEN_TRY([[maybe_unused]] const auto written, write_motion_array(out, own, motion));
    MIEN_TRY([[maybe_unused]] const auto copied, copy_sound(out, own, sound->second));
    ++result->num_sequences;
    result->num_frames += motion.shape[0];
  }
  if (result->num_sequences == 0)
    return Error{Errc::input, "'" + raw.string() + "'", "no sequence has both frames and sound",
                 "Sound is looked for as F1_e01_cut.wav"};
  MIEN_TRY(const Templates templates, scaler.templates(options));
  if (!templates.empty()) {
    MIEN_TRY([[maybe_unused]] const auto written, write_templates(out / "templates.safetensors", templates));
  }
  return result;
}

}  // namespace mien::datasets
