#include "set_check.h"

#include <algorithm>
#include <cmath>

#include "mien/base/number_text.h"
#include "mien/core/arkit.h"
#include "mien/corpus/emotion.h"
#include "mien/io/safetensors.h"

namespace mien {
namespace {

constexpr std::int64_t kBands = 64, kChannels = 55;
constexpr double kFps = 60, kMelRate = 100;
constexpr std::size_t kFirstSpeechBand = 9, kLastSpeechBand = 48;  // where a closure shows (spec section 1.4)
constexpr double kSealed = 0.04;

struct Tensors {
  std::span<const std::uint16_t> mel, curves;
  std::span<const float> level, intensity;
  std::span<const std::uint8_t> blink, raise, viseme, closure, accent, style, emotion, split;
  std::span<const std::int64_t> mel_start, frame_start;
  std::int64_t entries = 0, takes = 0, mels = 0, frames = 0;
};

Error broken(const std::string& what, const std::string& why) {
  return {Errc::incompatible, what, why, "Prepare the set again"};
}

Result<Tensors> open_tensors(const SafetensorsFile& file) {
  Tensors t;
  const auto* starts = file.find("mel_start");
  const auto* curves = file.find("curves");
  const auto* mel = file.find("mel");
  if (starts == nullptr || curves == nullptr || mel == nullptr || curves->shape.size() != 3 ||
      mel->shape.size() != 2 || starts->shape.size() != 1 || starts->shape[0] < 2)
    return broken("prepared set", "the tensors mel, curves and mel_start are not there in their shapes");
  t.entries = starts->shape[0] - 1;
  t.takes = curves->shape[0];
  t.frames = curves->shape[1];
  t.mels = mel->shape[0];
  const auto expect = [&](const char* name, std::vector<std::int64_t> shape) {
    return file.expect(name, shape);
  };
  for (const auto& [name, shape] : std::vector<std::pair<const char*, std::vector<std::int64_t>>>{
           {"mel", {t.mels, kBands}},
           {"level", {t.mels}},
           {"curves", {t.takes, t.frames, kChannels}},
           {"blink_onset", {t.takes, t.frames}},
           {"brow_raise", {t.takes, t.frames}},
           {"viseme", {t.frames}},
           {"closure", {t.frames}},
           {"accent", {t.frames}},
           {"mel_start", {t.entries + 1}},
           {"frame_start", {t.entries + 1}},
           {"style", {t.takes, t.entries}},
           {"latent", {t.takes, t.entries, 3}},
           {"emotion", {t.entries}},
           {"intensity", {t.entries}},
           {"split", {t.entries}}}) {
    MIEN_TRY(const auto* found, expect(name, shape));
    (void)found;
  }
  MIEN_TRY(t.mel, file.as<std::uint16_t>("mel"));
  MIEN_TRY(t.curves, file.as<std::uint16_t>("curves"));
  MIEN_TRY(t.level, file.as<float>("level"));
  MIEN_TRY(t.intensity, file.as<float>("intensity"));
  MIEN_TRY(t.blink, file.as<std::uint8_t>("blink_onset"));
  MIEN_TRY(t.raise, file.as<std::uint8_t>("brow_raise"));
  MIEN_TRY(t.viseme, file.as<std::uint8_t>("viseme"));
  MIEN_TRY(t.closure, file.as<std::uint8_t>("closure"));
  MIEN_TRY(t.accent, file.as<std::uint8_t>("accent"));
  MIEN_TRY(t.style, file.as<std::uint8_t>("style"));
  MIEN_TRY(t.emotion, file.as<std::uint8_t>("emotion"));
  MIEN_TRY(t.split, file.as<std::uint8_t>("split"));
  MIEN_TRY(t.mel_start, file.as<std::int64_t>("mel_start"));
  MIEN_TRY(t.frame_start, file.as<std::int64_t>("frame_start"));
  if (t.mel_start.front() != 0 || t.frame_start.front() != 0 || t.mel_start.back() != t.mels ||
      t.frame_start.back() != t.frames)
    return broken("prepared set", "mel_start or frame_start does not end at the number of frames");
  for (std::size_t i = 0; i + 1 < t.mel_start.size(); ++i)
    if (t.mel_start[i] >= t.mel_start[i + 1] || t.frame_start[i] >= t.frame_start[i + 1])
      return broken("prepared set", "entry " + std::to_string(i) + " is empty");
  return t;
}

Status measure_ranges(const Tensors& t, SetStatistics& s) {
  const auto range = [](auto& low, auto& high, float v, bool first) {
    low = first ? v : std::min(low, v);
    high = first ? v : std::max(high, v);
  };
  for (std::size_t i = 0; i < t.mel.size(); ++i) {
    const float v = half_to_float(t.mel[i]);
    if (!std::isfinite(v)) return broken("tensor 'mel'", "element " + std::to_string(i) + " is not finite");
    range(s.mel_min, s.mel_max, v, i == 0);
  }
  for (std::size_t i = 0; i < t.level.size(); ++i) {
    if (!std::isfinite(t.level[i]))
      return broken("tensor 'level'", "element " + std::to_string(i) + " is not finite");
    range(s.level_min, s.level_max, t.level[i], i == 0);
  }
  for (std::size_t i = 0; i < t.curves.size(); ++i) {
    const float v = half_to_float(t.curves[i]);
    const bool is_head = i % kChannels >= kNumArkit;
    if (!std::isfinite(v) || (!is_head && (v < 0 || v > 1)))
      return broken("tensor 'curves'",
                    "element " + std::to_string(i) + " is " + fixed(v, 4) + ", expected 0 ... 1");
    if (is_head)
      s.head_max_deg = std::max(s.head_max_deg, std::abs(v));
    else
      range(s.curve_min, s.curve_max, v, i == 0);
  }
  for (const auto v : t.viseme)
    if (v >= kNumVisemes) return broken("tensor 'viseme'", "a class of " + std::to_string(v));
  for (const auto e : t.emotion)
    if (e >= kNumEmotions) return broken("tensor 'emotion'", "a class of " + std::to_string(e));
  return Done{};
}

double speech_bands(const Tensors& t, std::int64_t mel) {
  double sum = 0;
  for (std::size_t b = kFirstSpeechBand; b <= kLastSpeechBand; ++b)
    sum += half_to_float(t.mel[static_cast<std::size_t>(mel * kBands) + b]);
  return sum / static_cast<double>(kLastSpeechBand - kFirstSpeechBand + 1);
}

// Closures of one entry: how far the sound falls in them, and how many takes really close.
void measure_closures(const Tensors& t, std::int64_t entry, SetStatistics& s, double& sealed) {
  const std::size_t jaw = arkit_index("jawOpen"), close = arkit_index("mouthClose");
  const auto i = static_cast<std::size_t>(entry);
  const std::int64_t first = t.frame_start[i], last = t.frame_start[i + 1];
  for (std::int64_t n = first; n < last; ++n) {
    if (t.closure[static_cast<std::size_t>(n)] == 0) continue;
    std::int64_t end = n;
    while (end < last && t.closure[static_cast<std::size_t>(end)] != 0) ++end;
    const double middle_s = static_cast<double>(n + end - 1 - 2 * first) / (2 * kFps);
    const std::int64_t mels = t.mel_start[i + 1] - t.mel_start[i];
    const auto at = [&](double second) {
      return t.mel_start[i] + std::clamp<std::int64_t>(std::llround(second * kMelRate), 0, mels - 1);
    };
    s.closure_dip += speech_bands(t, at(middle_s)) -
                     0.5 * (speech_bands(t, at(middle_s - 0.1)) + speech_bands(t, at(middle_s + 0.1)));
    ++s.closures;
    for (std::int64_t k = 0; k < t.takes; ++k) {
      bool is_sealed = false;
      for (std::int64_t m = std::max(first, n - 3); m < std::min(last, end + 3) && !is_sealed; ++m) {
        const auto* frame = &t.curves[static_cast<std::size_t>((k * t.frames + m) * kChannels)];
        is_sealed = half_to_float(frame[jaw]) - half_to_float(frame[close]) < kSealed;
      }
      sealed += is_sealed ? 1 : 0;
    }
    n = end;
  }
}

}  // namespace

Result<SetStatistics> check_set(const std::filesystem::path& path) {
  MIEN_TRY(const auto file, SafetensorsFile::open(path));
  MIEN_TRY(const Tensors t, open_tensors(file));
  SetStatistics s;
  if (const auto found = file.metadata().find("mien.set"); found != file.metadata().end())
    s.description = found->second;
  s.entries = t.entries;
  s.takes = t.takes;
  s.hours = static_cast<double>(t.frames) / kFps / 3600;
  MIEN_TRY(const Done in_range, measure_ranges(t, s));
  (void)in_range;
  double sealed = 0, accents = 0, blinks = 0, raises = 0;
  s.shortest_s = 1e9;
  for (std::int64_t e = 0; e < t.entries; ++e) {
    const auto i = static_cast<std::size_t>(e);
    const double seconds = static_cast<double>(t.frame_start[i + 1] - t.frame_start[i]) / kFps;
    s.shortest_s = std::min(s.shortest_s, seconds);
    s.longest_s = std::max(s.longest_s, seconds);
    s.valid_entries += t.split[i];
    ++s.entries_by_emotion[t.emotion[i]];
    measure_closures(t, e, s, sealed);
  }
  const std::size_t jaw = arkit_index("jawOpen");
  for (std::size_t n = 0; n < t.viseme.size(); ++n) {
    s.frames_by_viseme[t.viseme[n]] += 1;
    s.jaw_by_viseme[t.viseme[n]] += half_to_float(t.curves[n * kChannels + jaw]);
    accents += t.accent[n];
  }
  for (const auto b : t.blink) blinks += b;
  for (const auto r : t.raise) raises += r > 0;
  const double frames = static_cast<double>(t.frames);
  s.pause_share = s.frames_by_viseme[0] / frames;
  for (std::size_t v = 0; v < kNumVisemes; ++v) {
    if (s.frames_by_viseme[v] > 0) s.jaw_by_viseme[v] /= s.frames_by_viseme[v];
    s.frames_by_viseme[v] /= frames;
  }
  s.blinks_per_minute = blinks / static_cast<double>(t.takes) / (frames / kFps / 60);
  s.raises_per_minute = raises / static_cast<double>(t.takes) / (frames / kFps / 60);
  const double speech_s = frames / kFps * (1 - s.pause_share);
  s.accents_per_second = speech_s > 0 ? accents / speech_s : 0;
  if (s.closures > 0) {
    s.closure_dip /= static_cast<double>(s.closures);
    s.sealed_share = sealed / static_cast<double>(s.closures * t.takes);
  }
  return s;
}

std::string to_text(const SetStatistics& s) {
  std::string out = s.description + "\n";
  const auto line = [&out](const std::string& name, const std::string& value) {
    out += name + ": " + value + "\n";
  };
  line("entries", std::to_string(s.entries) + " (" + std::to_string(s.valid_entries) + " for validation), " +
                      std::to_string(s.takes) + " takes each, " + fixed(s.shortest_s, 1) + " to " +
                      fixed(s.longest_s, 1) + " s, " + fixed(s.hours, 2) + " h");
  line("log-mel", fixed(s.mel_min, 2) + " to " + fixed(s.mel_max, 2) + ", level " + fixed(s.level_min, 2) +
                      " to " + fixed(s.level_max, 2));
  line("coefficients", fixed(s.curve_min, 3) + " to " + fixed(s.curve_max, 3) + ", head within " +
                           fixed(s.head_max_deg, 1) + " degrees");
  line("blinks", fixed(s.blinks_per_minute, 1) + " a minute; brow raises: " + fixed(s.raises_per_minute, 1) +
                     " a minute; accents: " + fixed(s.accents_per_second, 2) +
                     " a second of speech; pauses: " + fixed(100 * s.pause_share, 1) + " % of the time");
  line("closures", std::to_string(s.closures) + ", the sound falls by " + fixed(-s.closure_dip, 2) +
                       " in them, " + fixed(100 * s.sealed_share, 1) + " % of all takes seal");
  out += "emotions:";
  for (std::size_t e = 0; e < s.entries_by_emotion.size(); ++e)
    out += " " + std::string(emotion_names()[e]) + " " + std::to_string(s.entries_by_emotion[e]);
  out += "\nvisemes (share of frames, mean jawOpen):";
  for (std::size_t v = 0; v < kNumVisemes; ++v)
    out += " " + std::string(viseme_names()[v]) + " " + fixed(100 * s.frames_by_viseme[v], 1) + "% " +
           fixed(s.jaw_by_viseme[v], 2);
  return out + "\n";
}

}  // namespace mien
