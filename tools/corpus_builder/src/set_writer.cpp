#include "set_writer.h"

#include <nlohmann/json.hpp>

#include "mien/base/contract.h"
#include "mien/core/arkit.h"
#include "mien/corpus/emotion.h"
#include "mien/corpus/speaker.h"
#include "mien/corpus/viseme.h"
#include "mien/io/safetensors.h"

namespace mien {
namespace {

constexpr int kMelBands = 64, kMotionFps = 60;
constexpr std::int64_t kChannels = 55;

std::string describe(const SetDescription& d) {
  nlohmann::json j;
  j["version"] = 2;
  j["fps"] = kMotionFps;
  j["channels"] = arkit_and_head_channels();
  for (const auto& speaker : fixed_speakers().first(kNumTrainingStyles)) j["styles"].push_back(speaker.id);
  for (const auto name : emotion_names()) j["emotions"].push_back(std::string(name));
  for (const auto name : viseme_names()) j["visemes"].push_back(std::string(name));
  j["seed"] = d.seed;
  j["hours"] = d.hours;
  j["engines"] = d.engines;
  j["licence"] = "made by mien-corpus from synthetic speech; no restriction (Apache-2.0 with the project)";
  return j.dump();
}

}  // namespace

Result<SetWriter> SetWriter::create(const std::filesystem::path& path, int num_takes) {
  SetWriter writer(path, num_takes);
  writer.spool_path_ = path;
  writer.spool_path_ += ".spool";
  writer.spool_.open(writer.spool_path_, std::ios::binary | std::ios::in | std::ios::out | std::ios::trunc);
  if (!writer.spool_)
    return Error{Errc::failed, "'" + writer.spool_path_.string() + "'", "cannot be written",
                 "Check that the folder exists"};
  return writer;
}

SetWriter::~SetWriter() {
  if (!spool_.is_open()) return;
  spool_.close();
  std::error_code ignored;
  std::filesystem::remove(spool_path_, ignored);
}

Status SetWriter::add(const PreparedEntry& e) {
  const auto n = static_cast<std::size_t>(e.num_frames()), t = static_cast<std::size_t>(e.num_mel());
  contract(e.takes.size() == static_cast<std::size_t>(num_takes_) && e.mel.size() == t * kMelBands &&
               e.closure.size() == n && e.accent.size() == n,
           "SetWriter::add: sizes of the entry disagree");
  for (const auto& take : e.takes)
    contract(take.curves.size() == n * kChannels && take.blink.size() == n && take.raise.size() == n,
             "SetWriter::add: sizes of a take disagree");
  Bytes bytes;
  append_entry(bytes, e);
  spool_.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!spool_)
    return Error{Errc::failed, "'" + spool_path_.string() + "'", "writing failed (disk full?)", ""};
  sizes_.push_back({static_cast<std::int64_t>(bytes.size()), e.num_mel(), e.num_frames()});
  return Done{};
}

Status SetWriter::finish(const SetDescription& description, Progress& progress) {
  if (sizes_.empty())
    return Error{Errc::failed, "'" + path_.string() + "'", "there is no entry to write", ""};
  const auto n = num_entries();
  std::vector<std::int64_t> mel_start{0}, frame_start{0};
  for (const auto& s : sizes_) {
    mel_start.push_back(mel_start.back() + s.mel);
    frame_start.push_back(frame_start.back() + s.frames);
  }
  const std::int64_t mels = mel_start.back(), frames = frame_start.back(), takes = num_takes_;
  MIEN_TRY(auto file, SafetensorsWriter::create(path_,
                                                {{"mel", Dtype::f16, {mels, kMelBands}},
                                                 {"level", Dtype::f32, {mels}},
                                                 {"curves", Dtype::f16, {takes, frames, kChannels}},
                                                 {"blink_onset", Dtype::u8, {takes, frames}},
                                                 {"brow_raise", Dtype::u8, {takes, frames}},
                                                 {"viseme", Dtype::u8, {frames}},
                                                 {"closure", Dtype::u8, {frames}},
                                                 {"accent", Dtype::u8, {frames}},
                                                 {"mel_start", Dtype::i64, {n + 1}},
                                                 {"frame_start", Dtype::i64, {n + 1}},
                                                 {"style", Dtype::u8, {takes, n}},
                                                 {"latent", Dtype::f32, {takes, n, 3}},
                                                 {"emotion", Dtype::u8, {n}},
                                                 {"intensity", Dtype::f32, {n}},
                                                 {"split", Dtype::u8, {n}}},
                                                {{"mien.set", describe(description)}}));
  Status state = file.write("mel_start", mel_start);
  if (state.has_value()) state = file.write("frame_start", frame_start);
  const auto put = [&](std::string_view name, std::int64_t first, const auto& values) {
    using Value = typename std::decay_t<decltype(values)>::value_type;
    if (state.has_value()) state = file.write_at(name, first, std::span<const Value>(values));
  };
  progress.stage("writing", n);
  spool_.seekg(0);
  for (std::int64_t i = 0; i < n && state.has_value(); ++i) {
    if (progress.cancelled()) return Error{Errc::cancelled, "prepare", "interrupted", ""};
    Bytes bytes(static_cast<std::size_t>(sizes_[static_cast<std::size_t>(i)].bytes));
    spool_.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    if (!spool_) return Error{Errc::failed, "'" + spool_path_.string() + "'", "reading back failed", ""};
    MIEN_TRY(const auto entries, parse_entries(bytes));
    const auto& e = entries.at(0);
    const std::int64_t mel = mel_start[static_cast<std::size_t>(i)],
                       frame = frame_start[static_cast<std::size_t>(i)];
    const auto one = [](auto value) { return std::vector{value}; };
    put("mel", mel * kMelBands, e.mel);
    put("level", mel, e.level);
    put("viseme", frame, e.viseme);
    put("closure", frame, e.closure);
    put("accent", frame, e.accent);
    put("emotion", i, one(e.emotion));
    put("intensity", i, one(e.intensity));
    put("split", i, one(e.split));
    for (std::int64_t k = 0; k < takes; ++k) {
      const auto& take = e.takes[static_cast<std::size_t>(k)];
      put("curves", (k * frames + frame) * kChannels, take.curves);
      put("blink_onset", k * frames + frame, take.blink);
      put("brow_raise", k * frames + frame, take.raise);
      put("style", k * n + i, one(take.style));
      put("latent", (k * n + i) * 3, take.latents);
    }
    progress.update(i + 1);
  }
  if (!state.has_value()) return state;
  return file.finish();
}

}  // namespace mien
