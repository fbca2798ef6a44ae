#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "mien/audio/load_audio.h"
#include "mien/base/file.h"
#include "mien/base/number_text.h"
#include "mien/datasets/prepared_files.h"
#include "preparers.h"

namespace mien::datasets {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr std::size_t kPieceFrames = 600;  // ten seconds at 60 frames a second
constexpr std::size_t kKeepEvery = 2;
constexpr std::size_t kPieceSamples = 10 * kModelSampleRateHz;

struct Recording {
  int emotion = 0;
  fs::path weights, sound;
};

std::vector<std::string> fields_of(const std::string& stem) {
  std::vector<std::string> fields;
  for (std::size_t at = 0; at <= stem.size();) {
    const auto end = std::min(stem.find('_', at), stem.size());
    fields.push_back(stem.substr(at, end - at));
    at = end + 1;
  }
  return fields;
}

// Scripted English recordings of every actor, in the order of their names.
struct Raw {
  std::map<std::string, std::map<std::string, Recording>> actors;
  std::vector<std::string> warnings;
};

Result<Raw> list_raw(const fs::path& folder) {
  std::error_code ec;
  Raw raw;
  fs::recursive_directory_iterator entries(folder, ec);
  if (ec) return Error{Errc::input, "'" + folder.string() + "'", "cannot be listed: " + ec.message(), ""};
  for (const auto& entry : entries) {
    const fs::path& path = entry.path();
    if (path.extension() != ".json") continue;
    const std::string stem = path.stem().string();
    const auto fields = fields_of(stem);
    const auto kind = fields.size() < 4 ? std::nullopt : parse_int(fields[2]);
    const auto emotion = fields.size() < 4 ? std::nullopt : parse_int(fields[3]);
    if (!kind || !emotion || fields[0].empty()) {
      raw.warnings.push_back("'" + path.string() +
                             "' is left out: its name is not <actor>_<name>_<kind>_<emotion>_...");
      continue;
    }
    if (*kind != 0) continue;  // conversation, or another language
    fs::path sound = path;
    sound.replace_extension(".wav");
    if (!fs::exists(sound, ec)) {
      raw.warnings.push_back("'" + path.string() + "' is left out: no sound of its name beside it");
      continue;
    }
    const int field = static_cast<int>(std::clamp<std::int64_t>(*emotion, 0, 1000));
    raw.actors[fields[0]].emplace(stem, Recording{beat_emotion(field), path, sound});
  }
  if (raw.actors.empty())
    return Error{Errc::input, "'" + folder.string() + "'", "holds no scripted recording of BEAT",
                 "Expected files such as 2/2_scott_0_65_65.json with their .wav"};
  return raw;
}

// [N, 51] at 60 frames a second.
Result<std::vector<float>> read_weights(const fs::path& path, std::size_t width) {
  const auto bad = [&](std::string why) {
    return Error{Errc::input, "'" + path.string() + "'", std::move(why), ""};
  };
  MIEN_TRY(const Bytes bytes, read_file(path));
  const Json json = Json::parse(as_text(bytes), nullptr, /*allow_exceptions=*/false);
  if (!json.is_object() || !json.contains("frames") || !json["frames"].is_array())
    return bad("is not JSON with a list 'frames'");
  std::vector<float> values;
  std::size_t n = 0;
  for (const Json& frame : json["frames"]) {
    const bool fits = frame.is_object() && frame.contains("weights") && frame["weights"].is_array() &&
                      frame["weights"].size() == width;
    if (!fits) return bad("frame " + std::to_string(n) + " has not " + std::to_string(width) + " weights");
    for (const Json& weight : frame["weights"]) {
      const float value = weight.is_number() ? weight.get<float>() : NAN;
      if (!std::isfinite(value))
        return bad("frame " + std::to_string(n) + " holds something that is no number");
      values.push_back(value);
    }
    ++n;
  }
  return values;
}

// Writes the whole pieces of a recording. `index` counts over the actor's pieces.
Status write_pieces(const std::string& actor, const Recording& recording, const fs::path& out,
                    std::size_t width, int& index, PrepareReport& report) {
  MIEN_TRY(const std::vector<float> values, read_weights(recording.weights, width));
  const auto clip = load_audio(recording.sound);
  if (!clip) return clip.error();
  const std::size_t num_pieces =
      std::min(values.size() / width / kPieceFrames, clip->samples.size() / kPieceSamples);
  for (std::size_t piece = 0; piece < num_pieces; ++piece) {
    NpyArray motion{{kPieceFrames / kKeepEvery, static_cast<std::int64_t>(width)}, {}};
    for (std::size_t n = 0; n < kPieceFrames; n += kKeepEvery) {
      const auto frame = values.begin() + static_cast<std::ptrdiff_t>((piece * kPieceFrames + n) * width);
      motion.values.insert(motion.values.end(), frame, frame + static_cast<std::ptrdiff_t>(width));
    }
    const auto start = clip->samples.begin() + static_cast<std::ptrdiff_t>(piece * kPieceSamples);
    const AudioClip sound{{start, start + static_cast<std::ptrdiff_t>(kPieceSamples)}};
    const std::string number = std::to_string(++index);
    const std::string name =
        actor + "_" + std::to_string(recording.emotion) + "_" + (number.size() < 2 ? "0" : "") + number;
    MIEN_TRY([[maybe_unused]] const auto written, write_motion_array(out, name, motion));
    MIEN_TRY([[maybe_unused]] const auto heard, write_sound(out, name, sound));
    ++report.num_sequences;
    report.num_frames += motion.shape[0];
  }
  return Done{};
}

}  // namespace

Result<PrepareReport> prepare_beat(const fs::path& raw, const fs::path& out, Progress& progress) {
  MIEN_TRY(const Raw found, list_raw(raw));
  MIEN_TRY([[maybe_unused]] const auto made, make_folders(out));
  const auto width = static_cast<std::size_t>(dataset_layout(DatasetKind::beat).width);
  Result<PrepareReport> result{PrepareReport{}};
  result.warnings = found.warnings;
  std::int64_t total = 0, done = 0;
  for (const auto& [actor, recordings] : found.actors) total += static_cast<std::int64_t>(recordings.size());
  progress.stage("recordings", total);
  for (const auto& [actor, recordings] : found.actors) {
    int index = 0;
    for (const auto& [name, recording] : recordings) {
      if (progress.cancelled()) return Error{Errc::cancelled, "", "interrupted", ""};
      MIEN_TRY([[maybe_unused]] const auto written,
               write_pieces(actor, recording, out, width, index, *result));
      progress.update(++done);
    }
  }
  if (result->num_sequences == 0)
    return Error{Errc::input, "'" + raw.string() + "'", "no recording is as long as a piece of ten seconds",
                 ""};
  return result;
}

}  // namespace mien::datasets
