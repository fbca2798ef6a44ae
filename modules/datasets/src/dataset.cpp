#include "mien/datasets/dataset.h"

#include <algorithm>
#include <cctype>
#include <map>

#include "mien/base/hash.h"
#include "mien/base/random.h"
#include "mien/core/arkit.h"
#include "mien/core/flame_parameters.h"
#include "mien/core/rig_controls.h"
#include "mien/io/mapped_file.h"
#include "mien/io/npy.h"

namespace mien {
namespace {

namespace fs = std::filesystem;
constexpr std::size_t kMaxWidth = 3'000'000;  // a mesh of a million vertices

// Files of one extension by their name without it.
Result<std::map<std::string, fs::path>> files_of(const fs::path& folder, std::string_view extension) {
  std::error_code ec;
  std::map<std::string, fs::path> files;
  fs::directory_iterator entries(folder, ec);
  if (ec)
    return Error{Errc::input, "'" + folder.string() + "'", "cannot be listed: " + ec.message(),
                 "A prepared data set has the folders wav and vertices_npy, or wav and param; see "
                 "docs/datasets.md"};
  for (const auto& entry : entries)
    if (entry.path().extension() == extension) files[entry.path().stem().string()] = entry.path();
  return files;
}

std::optional<DatasetKind> kind_of_folder(const fs::path& folder) {
  std::error_code ec;
  if (fs::is_directory(folder / dataset_layout(DatasetKind::mead).motion_folder, ec))
    return DatasetKind::mead;
  std::string name = fs::weakly_canonical(folder, ec).filename().string();
  for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (name.find("voca") != std::string::npos) return DatasetKind::vocaset;
  if (name.find("multiface") != std::string::npos) return DatasetKind::multiface;
  if (name.find("damm") != std::string::npos) return DatasetKind::uudamm;
  if (name.find("beat") != std::string::npos) return DatasetKind::beat;
  if (name.find("mead") != std::string::npos) return DatasetKind::mead_vertices;
  return std::nullopt;  // BIWI exists in two forms, which the names of its sequences tell apart
}

std::optional<DatasetKind> kind_of_content(const std::string& name, const fs::path& motion) {
  for (const auto kind : {DatasetKind::vocaset, DatasetKind::biwi, DatasetKind::mead_vertices})
    if (parse_sequence_name(kind, name)) return kind;
  const auto file = MappedFile::open(motion);
  if (!file) return std::nullopt;
  const auto layout = read_npy_layout(file->bytes());
  if (!layout || layout->shape.empty()) return std::nullopt;
  const std::int64_t width = frame_width(layout->shape);
  for (const auto known : dataset_names()) {
    const auto kind = parse_dataset_kind(known);
    if (kind && *kind != DatasetKind::biwi && dataset_layout(*kind).width == width) return kind;
  }
  return std::nullopt;
}

// BEAT's split: of every emotion of every subject a tenth tests and a ninth of the rest validates, drawn with
// seed 42. The authors drew on the order in which their disk listed the files; here the order is that of the
// names.
void split_beat(std::vector<DatasetSequence>& sequences) {
  std::map<std::pair<std::string, int>, std::vector<DatasetSequence*>> groups;
  for (auto& sequence : sequences)
    groups[{sequence.parts.subject, sequence.parts.emotion}].push_back(&sequence);
  for (auto& [key, members] : groups) {
    Rng random(hash_combine(hash64(key.first, 42), static_cast<std::uint64_t>(key.second)));
    for (std::size_t i = members.size(); i > 1; --i) std::swap(members[i - 1], members[random.below(i)]);
    const std::size_t num_test = (members.size() + 5) / 10, num_val = (members.size() - num_test + 4) / 9;
    for (std::size_t i = 0; i < members.size(); ++i)
      members[i]->split = i < num_test ? "test" : i < num_test + num_val ? "val" : "train";
  }
}

// ProbTalk3D's files have an axis of one clip.
bool is_batch_of_one(std::span<const std::int64_t> shape) {
  return shape.size() == 3 && shape[0] == 1 && shape[2] == static_cast<std::int64_t>(kNumFlame);
}

std::vector<std::string> channels_of(MotionSpace space) {
  if (space == MotionSpace::arkit) return arkit_order(ArkitOrder::beat);
  if (space == MotionSpace::flame) return flame_channels(kNumFlameShape, kNumFlameExpression);
  return uudamm_controls();
}

void find_templates(Dataset& dataset) {
  if (!dataset.layout->has_templates) return;
  std::error_code ec;
  for (const char* name : {"templates.safetensors", "templates.pkl", "templates_scaled.pkl"}) {
    const fs::path path = dataset.folder / name;
    if (!fs::exists(path, ec)) continue;
    auto templates = load_templates(path);
    if (templates)
      dataset.templates = std::move(*templates);
    else
      dataset.template_problem = templates.error().message();
    return;
  }
  dataset.template_problem = "there is no templates.pkl, templates_scaled.pkl or templates.safetensors";
}

}  // namespace

std::int64_t frame_count(std::span<const std::int64_t> shape) {
  return is_batch_of_one(shape) ? shape[1] : shape[0];
}

std::int64_t frame_width(std::span<const std::int64_t> shape) {
  if (shape.size() != 2 && shape.size() != 3) return 0;
  if (is_batch_of_one(shape)) return shape[2];
  std::size_t width = 1;
  for (const std::int64_t size : shape.subspan(1)) {
    const auto product = checked_multiply(width, static_cast<std::size_t>(size));
    if (!product || *product > kMaxWidth) return 0;
    width = *product;
  }
  return static_cast<std::int64_t>(width);
}

Result<Dataset> open_dataset(const fs::path& folder, std::optional<DatasetKind> kind) {
  if (!kind) kind = kind_of_folder(folder);
  const bool needs_sound = !kind || dataset_layout(*kind).needs_sound;
  auto sounds = files_of(folder / "wav", ".wav");
  if (!sounds && needs_sound) return sounds.error();
  if (!sounds) sounds = std::map<std::string, fs::path>();
  MIEN_TRY(const auto motions,
           files_of(folder / (kind ? dataset_layout(*kind).motion_folder : "vertices_npy"), ".npy"));
  if (!kind && !motions.empty()) kind = kind_of_content(motions.begin()->first, motions.begin()->second);
  if (!kind) {
    std::string known;
    for (const auto name : dataset_names()) known += (known.empty() ? "" : ", ") + std::string(name);
    return Error{Errc::incompatible, "'" + folder.string() + "'",
                 "its names do not tell which data set it is", "Say which with --layout: " + known};
  }
  Dataset dataset;
  dataset.layout = &dataset_layout(*kind);
  dataset.folder = folder;
  for (const auto& [name, motion] : motions) {
    const auto sound = sounds->find(name);
    const auto parts = parse_sequence_name(*kind, name);
    if (!parts) {
      dataset.strange_names.push_back(name);
    } else if (sound == sounds->end() && needs_sound) {
      dataset.unpaired_motion.push_back(name);
    } else {
      dataset.sequences.push_back({name, *parts, std::string(split_of(*kind, *parts).value_or("")),
                                   sound == sounds->end() ? fs::path() : sound->second, motion});
    }
  }
  for (const auto& [name, sound] : *sounds)
    if (!motions.contains(name)) dataset.unpaired_audio.push_back(name);
  if (*kind == DatasetKind::beat) split_beat(dataset.sequences);
  find_templates(dataset);
  return dataset;
}

Result<Motion> load_sequence(const Dataset& dataset, const DatasetSequence& sequence) {
  const std::string name = "'" + sequence.motion.string() + "'";
  MIEN_TRY(const auto file, MappedFile::open(sequence.motion));
  auto array = read_npy(file.bytes());
  if (!array) return within(array.error(), name);
  const DatasetLayout& layout = *dataset.layout;
  const std::int64_t width = frame_width(array->shape);
  const bool fits = layout.space == MotionSpace::vertices ? width % 3 == 0 : width == layout.width;
  if (width <= 0 || !fits)
    return Error{Errc::incompatible, name,
                 "its frames hold " + std::to_string(width) + " numbers, those of " +
                     std::string(layout.name) + " hold " + std::to_string(layout.width),
                 ""};
  std::vector<float> values = std::move(array->values);
  if (layout.keep_every > 1) {
    const auto size = static_cast<std::size_t>(width), every = static_cast<std::size_t>(layout.keep_every);
    std::size_t kept = 0;
    for (std::size_t n = 0; n * size < values.size(); n += every, ++kept)
      std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(n * size), size,
                  values.begin() + static_cast<std::ptrdiff_t>(kept * size));
    values.resize(kept * size);
  }
  if (layout.space == MotionSpace::vertices)
    return vertex_motion(topology_of(width / 3), layout.fps, std::move(values));
  return Motion{layout.space, channels_of(layout.space), layout.fps, std::move(values)};
}

Result<std::int64_t> loaded_width(const Dataset& dataset) {
  if (dataset.layout->space != MotionSpace::vertices) return dataset.layout->width;
  if (dataset.sequences.empty())
    return Error{Errc::incompatible, "'" + dataset.folder.string() + "'", "has no sequence",
                 "Run: mien data check"};
  MIEN_TRY(const Motion first, load_sequence(dataset, dataset.sequences.front()));
  return first.num_channels();
}

}  // namespace mien
