#include "mien/train/training_set.h"

#include <array>

#include "mien/base/bytes.h"
#include "mien/models/default/face_space.h"

namespace mien::train {
namespace {

constexpr std::int64_t kMelBands = 64;
constexpr std::size_t kNumChannels = 55;

}  // namespace

Result<TrainingSet> TrainingSet::open(const std::filesystem::path& path) {
  MIEN_TRY(auto file, SafetensorsFile::open(path));
  TrainingSet set(std::move(file));
  if (const auto mapped = set.map(); !mapped)
    return within(mapped.error(), "training set '" + path.string() + "'");
  return set;
}

Status TrainingSet::map() {
  using Sizes = std::vector<std::int64_t>;
  MIEN_TRY(const auto* mel, file_.expect("mel", Sizes{-1, kMelBands}));
  MIEN_TRY(const auto* curves,
           file_.expect("curves", Sizes{-1, -1, static_cast<std::int64_t>(kNumChannels)}));
  MIEN_TRY(const auto* mel_starts, file_.expect("mel_start", Sizes{-1}));
  const std::int64_t num_mel = mel->shape[0], n = mel_starts->shape[0] - 1;
  num_takes_ = curves->shape[0];
  num_frames_ = curves->shape[1];
  if (n < 1 || num_takes_ < 1) return Error{Errc::incompatible, "", "holds no entries", "Build it again"};
  for (const auto& [name, shape] :
       std::vector<std::pair<const char*, Sizes>>{{"level", {num_mel}},
                                                  {"blink_onset", {num_takes_, num_frames_}},
                                                  {"brow_raise", {num_takes_, num_frames_}},
                                                  {"viseme", {num_frames_}},
                                                  {"closure", {num_frames_}},
                                                  {"accent", {num_frames_}},
                                                  {"frame_start", {n + 1}},
                                                  {"style", {num_takes_, n}},
                                                  {"latent", {num_takes_, n, 3}},
                                                  {"emotion", {n}},
                                                  {"intensity", {n}},
                                                  {"split", {n}}}) {
    MIEN_TRY([[maybe_unused]] const auto* found, file_.expect(name, shape));
  }
  MIEN_TRY(mel_, file_.as<std::uint16_t>("mel"));
  MIEN_TRY(curves_, file_.as<std::uint16_t>("curves"));
  MIEN_TRY(level_, file_.as<float>("level"));
  MIEN_TRY(latents_, file_.as<float>("latent"));
  MIEN_TRY(blink_onsets_, file_.as<std::uint8_t>("blink_onset"));
  MIEN_TRY(brow_raises_, file_.as<std::uint8_t>("brow_raise"));
  MIEN_TRY(visemes_, file_.as<std::uint8_t>("viseme"));
  MIEN_TRY(closures_, file_.as<std::uint8_t>("closure"));
  MIEN_TRY(accents_, file_.as<std::uint8_t>("accent"));
  MIEN_TRY(styles_, file_.as<std::uint8_t>("style"));
  MIEN_TRY(const auto mel_start, file_.as<std::int64_t>("mel_start"));
  MIEN_TRY(const auto frame_start, file_.as<std::int64_t>("frame_start"));
  MIEN_TRY(const auto emotion, file_.as<std::uint8_t>("emotion"));
  MIEN_TRY(const auto intensity, file_.as<float>("intensity"));
  MIEN_TRY(const auto split, file_.as<std::uint8_t>("split"));
  for (std::size_t i = 0; i < static_cast<std::size_t>(n); ++i) {
    const Entry e{mel_start[i],   mel_start[i + 1] - mel_start[i],
                  frame_start[i], frame_start[i + 1] - frame_start[i],
                  emotion[i],     intensity[i],
                  split[i] != 0};
    if (e.num_mel <= 0 || e.num_frames <= 0 || e.mel_start < 0 || e.frame_start < 0 ||
        mel_start[i + 1] > num_mel || frame_start[i + 1] > num_frames_ || e.emotion > 7)
      return Error{Errc::incompatible, "entry " + std::to_string(i),
                   "its offsets or emotion are out of range", "Build the set again"};
    entries_.push_back(e);
  }
  const auto found = file_.metadata().find("mien.set");
  description_ = found == file_.metadata().end() ? "{}" : found->second;
  return Done{};
}

int TrainingSet::style(std::int64_t take, std::size_t entry) const {
  return styles_[static_cast<std::size_t>(take) * entries_.size() + entry];
}

std::span<const float> TrainingSet::latents(std::int64_t take, std::size_t entry) const {
  return latents_.subspan((static_cast<std::size_t>(take) * entries_.size() + entry) * 3, 3);
}

void TrainingSet::relative_mel(std::int64_t t, std::span<float> out) const {
  const float level = level_[static_cast<std::size_t>(t)];
  const auto frame = mel_.subspan(static_cast<std::size_t>(t * kMelBands), kMelBands);
  for (std::size_t b = 0; b < frame.size(); ++b) out[b] = half_to_float(frame[b]) - level;
}

void TrainingSet::face(std::int64_t take, std::int64_t n, std::span<float> out) const {
  std::array<float, kNumChannels> channels;
  const auto frame =
      curves_.subspan(static_cast<std::size_t>(take * num_frames_ + n) * kNumChannels, kNumChannels);
  for (std::size_t c = 0; c < kNumChannels; ++c) channels[c] = half_to_float(frame[c]);
  encode_face(channels, out);
}

bool TrainingSet::blink_onset(std::int64_t take, std::int64_t n) const {
  return blink_onsets_[static_cast<std::size_t>(take * num_frames_ + n)] != 0;
}

float TrainingSet::brow_raise(std::int64_t take, std::int64_t n) const {
  return static_cast<float>(brow_raises_[static_cast<std::size_t>(take * num_frames_ + n)]) / 255.0f;
}

}  // namespace mien::train
