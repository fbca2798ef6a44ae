#include "mien/datasets/check.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "mien/audio/load_audio.h"
#include "mien/base/number_text.h"
#include "mien/io/mapped_file.h"
#include "mien/io/npy.h"

namespace mien {
namespace {

constexpr double kMostDrift = 0.5;  // seconds between the end of the sound and the end of the motion

// Names under one finding, so that a thousand files of one fault are one line.
class Findings {
 public:
  void add(const std::string& finding, const std::string& name) { names_[finding].push_back(name); }
  [[nodiscard]] std::vector<std::string> lines(int most_named) const {
    std::vector<std::string> lines;
    for (const auto& [finding, names] : names_) {
      std::string line = finding + ": ";
      for (std::size_t i = 0; i < names.size(); ++i) {
        if (static_cast<int>(i) == most_named) {
          line += " and " + std::to_string(names.size() - i) + " more";
          break;
        }
        line += (i == 0 ? "" : ", ") + names[i];
      }
      lines.push_back(line);
    }
    return lines;
  }

 private:
  std::map<std::string, std::vector<std::string>> names_;
};

struct Collected {
  Findings problems, oddities;
  std::map<std::int64_t, std::vector<std::string>> widths;  // numbers in a frame -> sequences
  std::map<std::string, SplitCount> splits;
};

bool has_broken_number(std::span<const std::byte> data, std::size_t item_size) {
  for (std::size_t at = 0; at + item_size <= data.size(); at += item_size) {
    const double value =
        item_size == 4 ? static_cast<double>(*read_le<float>(data, at)) : *read_le<double>(data, at);
    if (!std::isfinite(value)) return true;
  }
  return false;
}

// Frames of the stored motion; 0 when it cannot be read.
std::int64_t check_motion(const DatasetSequence& sequence, const DatasetCheckOptions& options,
                          Collected& found) {
  const auto file = MappedFile::open(sequence.motion);
  if (!file) {
    found.problems.add("motion cannot be read", sequence.name);
    return 0;
  }
  const auto layout = read_npy_layout(file->bytes());
  if (!layout) {
    found.problems.add("motion is damaged (" + layout.error().why + ")", sequence.name);
    return 0;
  }
  const std::int64_t width = frame_width(layout->shape);
  if (width <= 0) {
    found.problems.add("motion is not an array of frames", sequence.name);
    return 0;
  }
  found.widths[width].push_back(sequence.name);
  if (layout->item_size == 8)
    found.oddities.add("motion is stored as float64 and is rounded when read", sequence.name);
  const std::int64_t num_frames = frame_count(layout->shape);
  if (num_frames == 0) found.problems.add("motion has no frames", sequence.name);
  if (options.read_values && has_broken_number(file->bytes().subspan(layout->data_offset), layout->item_size))
    found.problems.add("motion holds numbers that are not finite", sequence.name);
  return num_frames;
}

void check_sound(const Dataset& dataset, const DatasetSequence& sequence, std::int64_t num_frames,
                 Collected& found) {
  if (sequence.audio.empty()) return;  // the layout needs none
  const auto reader = AudioReader::open(sequence.audio);
  if (!reader) {
    found.problems.add("sound cannot be read (" + reader.error().why + ")", sequence.name);
    return;
  }
  const DatasetLayout& layout = *dataset.layout;
  const double rate = layout.fps * layout.keep_every;
  const double motion_seconds = static_cast<double>(num_frames) / rate;
  if (!reader->info().seconds || num_frames == 0) return;
  if (std::abs(*reader->info().seconds - motion_seconds) > kMostDrift)
    found.oddities.add(
        "sound and motion at " + fixed(rate, 0) + " frames a second differ by more than " +
            fixed(kMostDrift, 1) + " s",
        sequence.name + " (" + fixed(*reader->info().seconds, 2) + " s, " + fixed(motion_seconds, 2) + " s)");
}

void check_widths(const Dataset& dataset, Collected& found) {
  const std::int64_t expected = dataset.layout->width;
  for (const auto& [width, names] : found.widths) {
    if (width == expected) continue;
    const std::string text = "frames hold " + std::to_string(width) + " numbers, those of " +
                             std::string(dataset.layout->name) + " hold " + std::to_string(expected);
    const bool is_unusable = dataset.layout->space == MotionSpace::vertices ? width % 3 != 0 : true;
    // A mesh of another size throughout is a reduced or a test set; a mixture is a mistake.
    Findings& where = is_unusable || found.widths.size() > 1 ? found.problems : found.oddities;
    for (const auto& name : names) where.add(text, name);
  }
}

void check_templates(const Dataset& dataset, Collected& found) {
  if (!dataset.layout->has_templates) return;
  if (!dataset.template_problem.empty()) {
    found.problems.add("templates", dataset.template_problem);
    return;
  }
  std::set<std::string> missing;
  for (const auto& sequence : dataset.sequences)
    if (!dataset.templates.contains(sequence.parts.subject)) missing.insert(sequence.parts.subject);
  for (const auto& subject : missing) found.problems.add("subjects without a template", subject);
  if (found.widths.size() != 1 || dataset.templates.empty()) return;
  const std::int64_t width = found.widths.begin()->first;
  const auto size = static_cast<std::int64_t>(dataset.templates.begin()->second.size());
  if (size != width)
    found.problems.add("templates have another number of vertices than the motion",
                       std::to_string(size / 3) + " against " + std::to_string(width / 3));
}

std::vector<SplitCount> split_counts(const Dataset& dataset, Collected& found) {
  std::vector<SplitCount> counts;
  for (const char* split : {"train", "val", "test"}) {
    SplitCount count = found.splits[split];
    count.split = split;
    for (const auto& rule : dataset.layout->splits)
      if (rule.split == split) count.expected = rule.expected;
    if (count.found == 0) found.oddities.add("splits without a sequence", split);
    if (count.found != 0 && count.found < count.expected)
      found.oddities.add("splits with fewer sequences than the full data set",
                         std::string(split) + " (" + std::to_string(count.found) + " of " +
                             std::to_string(count.expected) + ")");
    counts.push_back(count);
  }
  if (SplitCount none = found.splits[""]; none.found > 0) {
    none.split = "none";
    counts.push_back(none);
  }
  return counts;
}

}  // namespace

Result<DatasetReport> check_dataset(const Dataset& dataset, const DatasetCheckOptions& options,
                                    Progress& progress) {
  Collected found;
  progress.stage("sequences", static_cast<std::int64_t>(dataset.sequences.size()));
  for (std::size_t i = 0; i < dataset.sequences.size(); ++i) {
    if (progress.cancelled()) return Error{Errc::cancelled, "", "interrupted", ""};
    const auto& sequence = dataset.sequences[i];
    const std::int64_t num_frames = check_motion(sequence, options, found);
    check_sound(dataset, sequence, num_frames, found);
    auto& split = found.splits[sequence.split];
    ++split.found;
    split.num_frames += num_frames;
    progress.update(static_cast<std::int64_t>(i) + 1);
  }
  if (dataset.sequences.empty())
    found.problems.add("no sequence has both sound and motion", dataset.folder.string());
  for (const auto& name : dataset.unpaired_motion)
    found.oddities.add("motion without sound (left out)", name);
  for (const auto& name : dataset.unpaired_audio) found.oddities.add("sound without motion (left out)", name);
  for (const auto& name : dataset.strange_names)
    found.oddities.add("names that are none of " + std::string(dataset.layout->name) + " (left out)", name);
  check_widths(dataset, found);
  check_templates(dataset, found);
  DatasetReport report;
  report.splits = split_counts(dataset, found);
  report.problems = found.problems.lines(options.most_named);
  report.oddities = found.oddities.lines(options.most_named);
  return report;
}

}  // namespace mien
