#include "keep_words.h"

#include <CLI/CLI.hpp>
#include <cmath>
#include <map>

#include "mien/base/file.h"
#include "mien/base/number_text.h"
#include "mien/io/edit_csv.h"
#include "mien/metrics/vertex_regions.h"
#include "mien/models/model_file.h"
#include "nearest_name.h"

namespace mien {
namespace {

std::string list_of(const std::vector<std::string>& names) {
  std::string list;
  for (const auto& name : names) list += (list.empty() ? "" : ", ") + name;
  return list;
}

Error unknown_channel(Errc code, const std::string& where, const std::string& name, const Motion& motion) {
  if (motion.space == MotionSpace::vertices)
    return {code, where + " '" + name + "'", "the motion has vertices and no named channels", ""};
  const std::string near = nearest_name(name, motion.channels);
  return {code, where + " '" + name + "'", "the motion has no such channel",
          (near.empty() ? "" : "Did you mean " + near + "? ") + "It has: " + list_of(motion.channels)};
}

// Vertices that a word of --lock stands for: a region of the model file, or a file of indices.
Result<std::vector<std::int64_t>> vertices_of(const std::string& word, const Motion& motion,
                                              const SafetensorsFile& model) {
  const std::string what = "--lock '" + word + "'";
  std::vector<std::int64_t> vertices;
  std::vector<std::string> regions;
  for (const auto& tensor : model.tensors()) {
    if (!tensor.name.starts_with(ModelFile::kRegionPrefix)) continue;
    regions.push_back(tensor.name.substr(ModelFile::kRegionPrefix.size()));
    if (regions.back() != word) continue;
    MIEN_TRY(const auto indices, model.as<std::int64_t>(tensor.name));
    vertices.assign(indices.begin(), indices.end());
  }
  std::error_code ec;
  if (vertices.empty() && std::filesystem::is_regular_file(word, ec)) {
    MIEN_TRY(const Bytes bytes, read_file(word));
    const auto indices = read_region(as_text(bytes), motion.topology.num_vertices, kMouthWeightAbove);
    if (!indices) return within(indices.error(), what);
    vertices.assign(indices->begin(), indices->end());
  }
  if (vertices.empty())
    return Error{Errc::usage, what, "is neither a region of the model nor a file of vertex indices",
                 regions.empty() ? "The model has no regions: pass a file" : "It has: " + list_of(regions)};
  for (const std::int64_t v : vertices)
    if (v < 0 || v >= motion.topology.num_vertices)
      return Error{
          Errc::incompatible, what,
          "names vertex " + std::to_string(v) + " of " + std::to_string(motion.topology.num_vertices), ""};
  return vertices;
}

Status keep_locked(const std::string& word, const Motion& motion, const SafetensorsFile& model,
                   KeptValues& kept) {
  std::vector<std::int64_t> channels;
  if (motion.space == MotionSpace::vertices) {
    MIEN_TRY(const auto vertices, vertices_of(word, motion, model));
    for (const std::int64_t v : vertices)
      for (const std::int64_t axis : {0, 1, 2}) channels.push_back(3 * v + axis);
  } else {
    channels = matching_channels(motion, word);
    if (channels.empty()) return unknown_channel(Errc::usage, "--lock", word, motion);
  }
  for (const std::int64_t c : channels) kept.keep_channel(c);
  return Done{};
}

Status keep_mask(const std::string& path, const Motion& motion, KeptValues& kept) {
  MIEN_TRY(const Bytes bytes, read_file(path));
  const std::string name = "mask '" + path + "'";
  const auto table = read_mask_csv(as_text(bytes));
  if (!table) return within(table.error(), name);
  const std::size_t width = table->channels.size();
  const auto num_frames = static_cast<std::int64_t>(table->weights.size() / width);
  if (num_frames != motion.num_frames())
    return Error{Errc::incompatible, name,
                 "has " + std::to_string(num_frames) + " lines, the motion " +
                     std::to_string(motion.num_frames()) + " frames",
                 "Write a line for each frame"};
  std::vector<bool> is_named(static_cast<std::size_t>(motion.num_channels()));
  for (std::size_t i = 0; i < width; ++i) {
    const auto found = matching_channels(motion, table->channels[i]);
    if (found.size() != 1)
      return unknown_channel(Errc::incompatible, name + ": channel", table->channels[i], motion);
    is_named[static_cast<std::size_t>(found.front())] = true;
    for (std::int64_t n = 0; n < num_frames; ++n)
      kept.keep(n, found.front(), table->weights[static_cast<std::size_t>(n) * width + i]);
  }
  std::int64_t num_unnamed = 0;
  for (std::int64_t c = 0; c < motion.num_channels(); ++c) {
    if (is_named[static_cast<std::size_t>(c)]) continue;
    kept.keep_channel(c);
    ++num_unnamed;
  }
  Status status = Done{};
  if (num_unnamed > 0)
    status.warnings.push_back(name + " does not name " + std::to_string(num_unnamed) + " of the " +
                              std::to_string(motion.num_channels()) + " channels: they are kept");
  return status;
}

Status keep_keys(const std::string& path, const Motion& motion, KeptValues& kept) {
  MIEN_TRY(const Bytes bytes, read_file(path));
  const std::string name = "keys '" + path + "'";
  const auto keys = read_keys_csv(as_text(bytes));
  if (!keys) return within(keys.error(), name);
  std::map<std::pair<std::int64_t, std::int64_t>, float> set;
  for (const MotionKey& key : *keys) {
    const auto found = matching_channels(motion, key.channel);
    if (found.size() != 1)
      return unknown_channel(Errc::incompatible, name + ": channel", key.channel, motion);
    const std::string what = name + ": " + key.channel + " at " + fixed(key.seconds, 3) + " s";
    const double at = std::round(key.seconds * motion.fps);
    if (at >= static_cast<double>(motion.num_frames()))
      return Error{Errc::incompatible, what,
                   "lies beyond the end of the motion at " + fixed(motion.seconds(), 3) + " s", ""};
    const auto n = static_cast<std::int64_t>(at);
    const std::int64_t c = found.front();
    const float value = key.value.value_or(motion.frame(n)[static_cast<std::size_t>(c)]);
    const auto [before, is_new] = set.insert({{n, c}, value});
    if (!is_new && before->second != value)
      return Error{Errc::incompatible, what, "another key sets the same frame to " + shortest(before->second),
                   ""};
    if (is_new && kept.keeps(n, c) && value != kept.value(n, c))
      return Error{Errc::incompatible, what, "the value there is kept: it lies outside of what is made anew",
                   "Let --range hold the key, or do not lock its channel"};
    kept.set(n, c, value);
  }
  return Done{};
}

}  // namespace

void add_keep_options(CLI::App& command, KeepWords& words) {
  command
      .add_option("--range", words.ranges,
                  "Stretch to make anew, in seconds: 1.20-2.05; may be repeated. Everything outside is kept. "
                  "Default: all of the motion")
      ->allow_extra_args(false);
  command
      .add_option(
          "--lock", words.locks,
          "Channels to keep, while the others are made anew around them: jawOpen,mouthSmile*; of vertices, "
          "regions of the model file or files of vertex indices; may be repeated")
      ->delimiter(',')
      ->allow_extra_args(false);
  command.add_option(
      "--mask", words.mask,
      "CSV with a header of channel names and a line per frame: 1 keeps a value, 0 makes it anew, "
      "between them they are blended");
  command.add_option("--keep-keys", words.keys,
                     "CSV with the header time,channel,value: values set by hand that the new motion passes "
                     "through; an empty value is that of the motion");
}

Result<KeptValues> kept_values(const KeepWords& words, const Motion& motion, const SafetensorsFile& model) {
  if (words.ranges.empty() && words.locks.empty() && words.mask.empty() && words.keys.empty())
    return Error{Errc::usage, "mien edit", "nothing says what to make anew and what to keep",
                 "Pass --range, --lock, --mask or --keep-keys; mien animate makes all of a motion"};
  KeptValues kept(motion);
  std::vector<std::string> warnings;
  if (!words.ranges.empty()) {
    std::vector<FrameRange> stretches;
    for (const auto& range : words.ranges) {
      const auto frames = frames_of_range(range, motion);
      if (!frames) return within(frames.error(), "--range");
      stretches.push_back(*frames);
    }
    kept.keep_outside(stretches);
  }
  for (const auto& word : words.locks) {
    MIEN_TRY([[maybe_unused]] const auto locked, keep_locked(word, motion, model, kept));
  }
  if (!words.mask.empty()) {
    const auto masked = keep_mask(words.mask, motion, kept);
    if (!masked) return masked.error();
    warnings = masked.warnings;
  }
  if (!words.keys.empty()) {
    const auto keyed = keep_keys(words.keys, motion, kept);
    if (!keyed) return keyed.error();
  }
  if (kept.edited() == FrameRange{})
    return Error{Errc::usage, "mien edit", "everything is kept: there is nothing to make anew",
                 "Lock fewer channels, or mask less"};
  Result<KeptValues> result(std::move(kept));
  result.warnings = std::move(warnings);
  return result;
}

}  // namespace mien
