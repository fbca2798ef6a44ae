#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "mien/audio/load_audio.h"
#include "mien/datasets/prepared_files.h"
#include "mien/io/mapped_file.h"
#include "mien/io/min_max_scaler.h"
#include "mien/io/safetensors.h"
#include "preparers.h"

namespace mien::datasets {
namespace {

namespace fs = std::filesystem;
constexpr std::size_t kKeepEvery = 4;      // of 120 frames a second
constexpr std::size_t kPieceFrames = 300;  // ten seconds at 30
constexpr std::size_t kPieceSamples = 10 * kModelSampleRateHz;

// By actor and name.
using Recordings = std::map<std::string, std::map<std::string, fs::path>>;

Result<Recordings> list_raw(const fs::path& folder, std::vector<std::string>& warnings) {
  std::error_code ec;
  fs::recursive_directory_iterator entries(folder, ec);
  if (ec) return Error{Errc::input, "'" + folder.string() + "'", "cannot be listed: " + ec.message(), ""};
  Recordings found;
  for (const auto& entry : entries) {
    if (entry.path().extension() != ".npy") continue;
    const std::string stem = entry.path().stem().string();
    const auto cut = stem.find('_');
    fs::path sound = entry.path();
    sound.replace_extension(".wav");
    if (cut == 0 || cut == std::string::npos)
      warnings.push_back("'" + entry.path().string() + "' is left out: its name is not <actor>_<recording>");
    else if (!fs::exists(sound, ec))
      warnings.push_back("'" + entry.path().string() + "' is left out: no sound of its name beside it");
    else
      found[stem.substr(0, cut)].emplace(stem, entry.path());
  }
  if (found.empty())
    return Error{
        Errc::input, "'" + folder.string() + "'", "holds no recording of UUDaMM",
        "Expected are arrays [frames, 192] at 120 frames a second, such as 1_take01.npy with 1_take01.wav"};
  return found;
}

// Every fourth frame, [N, width].
Result<std::vector<float>> read_controls(const fs::path& path, std::size_t width) {
  MIEN_TRY(const auto file, MappedFile::open(path));
  auto array = read_npy(file.bytes());
  if (!array) return within(array.error(), "'" + path.string() + "'");
  if (array->shape.size() != 2 || array->shape[1] != static_cast<std::int64_t>(width))
    return Error{Errc::incompatible, "'" + path.string() + "'",
                 "is no array [frames, " + std::to_string(width) + "]", ""};
  std::vector<float> kept;
  for (std::size_t at = 0; at < array->values.size(); at += kKeepEvery * width)
    kept.insert(kept.end(), array->values.begin() + static_cast<std::ptrdiff_t>(at),
                array->values.begin() + static_cast<std::ptrdiff_t>(at + width));
  for (std::size_t i = 0; i < kept.size(); ++i)
    if (!std::isfinite(kept[i]))
      return Error{Errc::input, "'" + path.string() + "'",
                   "frame " + std::to_string(i / width * kKeepEvery) + " is not finite", ""};
  return kept;
}

std::size_t num_pieces(const std::vector<float>& values, std::size_t width, std::size_t num_samples) {
  return std::min(values.size() / width / kPieceFrames, num_samples / kPieceSamples);
}

/// Range of every channel, as scikit-learn's MinMaxScaler fits it to -1 ... 1: a channel that stands still
/// keeps its unit.
class RangeFit {
 public:
  explicit RangeFit(std::size_t width)
      : least_(width, std::numeric_limits<double>::infinity()), most_(width, -least_.front()) {}
  void add(std::span<const float> values) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      const std::size_t c = i % least_.size();
      least_[c] = std::min(least_[c], static_cast<double>(values[i]));
      most_[c] = std::max(most_[c], static_cast<double>(values[i]));
    }
  }
  [[nodiscard]] MinMaxScaler scaler() const {
    MinMaxScaler s;
    for (std::size_t c = 0; c < least_.size(); ++c) {
      const double range = most_[c] - least_[c];
      s.scale.push_back(2 / (range > 0 ? range : 1));
      s.min.push_back(-1 - least_[c] * s.scale.back());
    }
    return s;
  }

 private:
  std::vector<double> least_, most_;
};

Status write_scaler(const fs::path& path, const MinMaxScaler& scaler) {
  const auto count = static_cast<std::int64_t>(scaler.scale.size());
  MIEN_TRY(auto writer,
           SafetensorsWriter::create(path, {{"scale_", Dtype::f64, {count}}, {"min_", Dtype::f64, {count}}}));
  MIEN_TRY([[maybe_unused]] const auto scales, writer.write("scale_", scaler.scale));
  MIEN_TRY([[maybe_unused]] const auto minima, writer.write("min_", scaler.min));
  return writer.finish();
}

}  // namespace

Result<PrepareReport> prepare_uudamm(const fs::path& raw, const fs::path& out, const PrepareOptions& options,
                                     Progress& progress) {
  const auto width = static_cast<std::size_t>(dataset_layout(DatasetKind::uudamm).width);
  Result<PrepareReport> result{PrepareReport{}};
  MIEN_TRY(const Recordings found, list_raw(raw, result.warnings));
  std::optional<MinMaxScaler> scaler;
  if (!options.scaler.empty()) {
    MIEN_TRY(scaler, read_min_max_scaler(options.scaler, static_cast<std::int64_t>(width)));
  }
  std::int64_t total = 0, done = 0;
  for (const auto& [actor, recordings] : found) total += static_cast<std::int64_t>(recordings.size());
  // The pieces of every recording, in order.
  const auto for_each_recording = [&](auto&& use) -> Status {
    done = 0;
    for (const auto& [actor, recordings] : found) {
      int index = 0;
      for (const auto& [name, path] : recordings) {
        if (progress.cancelled()) return Error{Errc::cancelled, "", "interrupted", ""};
        MIEN_TRY(std::vector<float> values, read_controls(path, width));
        MIEN_TRY([[maybe_unused]] const auto used, use(actor, path, std::move(values), index));
        progress.update(++done);
      }
    }
    return Done{};
  };
  if (!scaler) {
    progress.stage("ranges", total);
    RangeFit fit(width);
    MIEN_TRY([[maybe_unused]] const auto measured,
             for_each_recording(
                 [&](const std::string&, const fs::path&, std::vector<float> values, int&) -> Status {
                   fit.add(values);
                   return Done{};
                 }));
    scaler = fit.scaler();
  }
  MIEN_TRY([[maybe_unused]] const auto made, make_folders(out));
  progress.stage("recordings", total);
  const auto write = [&](const std::string& actor, const fs::path& path, std::vector<float> values,
                         int& index) -> Status {
    fs::path sound = path;
    MIEN_TRY(const AudioClip clip, load_audio(sound.replace_extension(".wav")));
    for (std::size_t i = 0; i < values.size(); ++i)
      values[i] = static_cast<float>(static_cast<double>(values[i]) * scaler->scale[i % width] +
                                     scaler->min[i % width]);
    const std::size_t count = num_pieces(values, width, clip.samples.size());
    for (std::size_t piece = 0; piece < count; ++piece) {
      const auto first = values.begin() + static_cast<std::ptrdiff_t>(piece * kPieceFrames * width);
      const NpyArray motion{{kPieceFrames, static_cast<std::int64_t>(width)},
                            {first, first + static_cast<std::ptrdiff_t>(kPieceFrames * width)}};
      const auto start = clip.samples.begin() + static_cast<std::ptrdiff_t>(piece * kPieceSamples);
      const std::string number = std::to_string(++index),
                        name = actor + "_" + (number.size() < 2 ? "0" : "") + number;
      MIEN_TRY([[maybe_unused]] const auto written, write_motion_array(out, name, motion));
      MIEN_TRY([[maybe_unused]] const auto heard,
               write_sound(out, name, {{start, start + static_cast<std::ptrdiff_t>(kPieceSamples)}}));
      ++result->num_sequences;
      result->num_frames += motion.shape[0];
    }
    return Done{};
  };
  MIEN_TRY([[maybe_unused]] const auto written, for_each_recording(write));
  if (result->num_sequences == 0)
    return Error{Errc::input, "'" + raw.string() + "'", "no recording is as long as a piece of ten seconds",
                 ""};
  if (options.scaler.empty()) {
    MIEN_TRY([[maybe_unused]] const auto kept, write_scaler(out / "scaler.safetensors", *scaler));
  }
  return result;
}

}  // namespace mien::datasets
