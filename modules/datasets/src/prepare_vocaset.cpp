#include <cmath>
#include <cstring>
#include <map>

#include "mien/datasets/prepared_files.h"
#include "mien/datasets/templates.h"
#include "mien/io/mapped_file.h"
#include "mien/io/pickle.h"
#include "preparers.h"

namespace mien::datasets {
namespace {

namespace fs = std::filesystem;

Error unfit(const fs::path& path, std::string why) {
  return {Errc::incompatible, "'" + path.string() + "'", std::move(why), ""};
}

/// The table of all frames, [F, V, 3], mapped: it holds gigabytes.
class FrameTable {
 public:
  static Result<FrameTable> open(const fs::path& path) {
    FrameTable table;
    MIEN_TRY(table.file_, MappedFile::open(path));
    auto layout = read_npy_layout(table.file_.bytes());
    if (!layout) return within(layout.error(), "'" + path.string() + "'");
    table.layout_ = std::move(*layout);
    const auto& shape = table.layout_.shape;
    if (!((shape.size() == 3 && shape[2] == 3) || (shape.size() == 2 && shape[1] % 3 == 0)) || shape[1] == 0)
      return unfit(path, "is no table of frames [F, V, 3]");
    table.width_ = shape.size() == 3 ? 3 * shape[1] : shape[1];
    return table;
  }
  [[nodiscard]] std::int64_t num_rows() const { return layout_.shape[0]; }
  [[nodiscard]] std::int64_t width() const { return width_; }
  /// @pre 0 <= row < num_rows()
  void append(std::int64_t row, std::vector<float>& values) const {
    const auto count = static_cast<std::size_t>(width_);
    const std::byte* from = file_.bytes().data() + layout_.data_offset +
                            static_cast<std::size_t>(row) * count * layout_.item_size;
    const std::size_t start = values.size();
    values.resize(start + count);
    if (layout_.item_size == sizeof(float)) {
      std::memcpy(values.data() + start, from, count * sizeof(float));
      return;
    }
    for (std::size_t i = 0; i < count; ++i) {
      double value = 0;
      std::memcpy(&value, from + i * sizeof(double), sizeof(double));
      values[start + i] = static_cast<float>(value);
    }
  }

 private:
  MappedFile file_;
  NpyLayout layout_;
  std::int64_t width_ = 0;
};

// frame -> row, in the order of the frames.
Result<std::map<std::int64_t, std::int64_t>> rows_of(const PickleValue& frames, const fs::path& path,
                                                     const FrameTable& table) {
  std::map<std::int64_t, std::int64_t> rows;
  if (frames.kind() != PickleKind::dict) return unfit(path, "has a sentence that is no dictionary of frames");
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const auto frame = frames.key(i).integer(), row = frames[i].integer();
    if (!frame || !row || *row < 0 || *row >= table.num_rows())
      return unfit(path, "names a frame that is not among the " + std::to_string(table.num_rows()) +
                             " of data_verts.npy");
    rows[*frame] = *row;
  }
  return rows;
}

// {"audio": array, "sample_rate": number}: integers are parts of full scale, channels are averaged.
Result<AudioClip> sound_of(const PickleValue& entry, const fs::path& path) {
  const auto audio = entry.find("audio"), rate = entry.find("sample_rate");
  const PickleArray* array = audio ? audio->array() : nullptr;
  const auto hz = rate ? rate->number() : std::nullopt;
  if (array == nullptr || !hz || !(*hz >= 1000 && *hz <= 192'000) || array->shape.empty() ||
      array->shape.size() > 2)
    return unfit(path, "has a sentence without an array 'audio' and its 'sample_rate'");
  MIEN_TRY(const auto values, array->to_floats());
  const float scale =
      array->kind == 'i' ? std::ldexp(1.0f, 1 - 8 * static_cast<int>(array->item_size)) : 1.0f;
  const auto channels = static_cast<std::size_t>(array->shape.size() == 2 ? array->shape[1] : 1);
  AudioClip clip;
  clip.sample_rate_hz = static_cast<int>(std::lround(*hz));
  for (std::size_t at = 0; channels > 0 && at < values.size(); at += channels) {
    float sum = 0;
    for (std::size_t c = 0; c < channels; ++c) sum += values[at + c];
    clip.samples.push_back(scale * sum / static_cast<float>(channels));
  }
  return clip;
}

}  // namespace

Result<PrepareReport> prepare_vocaset(const fs::path& raw, const fs::path& out, const PrepareOptions& options,
                                      Progress& progress) {
  const fs::path index_path = raw / "subj_seq_to_idx.pkl", audio_path = raw / "raw_audio_fixed.pkl";
  MIEN_TRY(const FrameTable table, FrameTable::open(raw / "data_verts.npy"));
  MIEN_TRY(const Pickle index, Pickle::open(index_path));
  MIEN_TRY(const Pickle audio, Pickle::open(audio_path));
  MIEN_TRY(const Templates templates,
           load_templates(options.templates.empty() ? raw / "templates.pkl" : options.templates));
  if (static_cast<std::int64_t>(templates.begin()->second.size()) != table.width())
    return unfit(raw / "data_verts.npy", "has " + std::to_string(table.width() / 3) +
                                             " vertices, the templates " +
                                             std::to_string(templates.begin()->second.size() / 3));
  const PickleValue subjects = index.root(), sounds = audio.root();
  if (subjects.kind() != PickleKind::dict || sounds.kind() != PickleKind::dict)
    return unfit(subjects.kind() != PickleKind::dict ? index_path : audio_path,
                 "is no dictionary of subjects");
  MIEN_TRY([[maybe_unused]] const auto made, make_folders(out));
  Result<PrepareReport> result{PrepareReport{}};
  progress.stage("subjects", static_cast<std::int64_t>(subjects.size()));
  for (std::size_t s = 0; s < subjects.size(); ++s) {
    const auto subject = subjects.key(s).text();
    if (!subject || subjects[s].kind() != PickleKind::dict)
      return unfit(index_path, "has a subject that is no dictionary of sentences");
    const auto heard = sounds.find(*subject);
    for (std::size_t i = 0; i < subjects[s].size(); ++i) {
      if (progress.cancelled()) return Error{Errc::cancelled, "", "interrupted", ""};
      const std::string sentence(subjects[s].key(i).text().value_or(""));
      const std::string name = std::string(*subject) + "_" + sentence;
      const auto leave_out = [&](const char* why) {
        result.warnings.push_back(name + " is left out: " + why);
      };
      // A name from the file becomes a name on disk: only what the data set has.
      const auto parts = parse_sequence_name(DatasetKind::vocaset, name);
      if (!parts || name.find('/') != std::string::npos) {
        leave_out("its name is not <subject>_sentenceNN");
        continue;
      }
      const auto entry = heard && heard->kind() == PickleKind::dict ? heard->find(sentence) : std::nullopt;
      if (!entry || entry->kind() != PickleKind::dict) {
        leave_out("no sound");
        continue;
      }
      MIEN_TRY(const auto rows, rows_of(subjects[s][i], index_path, table));
      MIEN_TRY(const AudioClip clip, sound_of(*entry, audio_path));
      NpyArray motion{{static_cast<std::int64_t>(rows.size()), table.width()}, {}};
      motion.values.reserve(rows.size() * static_cast<std::size_t>(table.width()));
      for (const auto& [frame, row] : rows) table.append(row, motion.values);
      MIEN_TRY([[maybe_unused]] const auto written, write_motion_array(out, name, motion));
      MIEN_TRY([[maybe_unused]] const auto sound, write_sound(out, name, clip));
      ++result->num_sequences;
      result->num_frames += motion.shape[0];
    }
    progress.update(static_cast<std::int64_t>(s) + 1);
  }
  if (result->num_sequences == 0)
    return Error{Errc::input, "'" + raw.string() + "'", "no sentence has both frames and sound", ""};
  MIEN_TRY([[maybe_unused]] const auto kept, write_templates(out / "templates.safetensors", templates));
  return result;
}

}  // namespace mien::datasets
