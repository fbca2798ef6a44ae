#include "mien/metrics/benchmark_set.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "mien/base/file.h"

namespace mien {
namespace {

constexpr std::size_t kMaxClips = 100'000;
constexpr std::string_view kNoisySuffix = "_noisy";

std::optional<std::string> text_member(const nlohmann::json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_string()) return std::nullopt;
  return found->get<std::string>();
}

// A path below the manifest's folder: relative and without "..".
bool stays_inside(const std::filesystem::path& path) {
  if (path.empty() || path.is_absolute()) return false;
  for (const auto& part : path)
    if (part == "..") return false;
  return true;
}

// An error text, or nothing.
std::optional<std::string> parse_clip(const nlohmann::json& object, const std::filesystem::path& folder,
                                      BenchmarkClip& clip) {
  if (!object.is_object()) return "is not an object";
  const auto id = text_member(object, "id"), file = text_member(object, "file"),
             labels = text_member(object, "labels"), language = text_member(object, "language"),
             speaker = text_member(object, "speaker"), style = text_member(object, "style");
  if (!id || id->empty()) return "has no text member 'id'";
  if (!file || !labels || !language || !speaker || !style)
    return "'" + *id + "' needs the text members file, labels, language, speaker, style";
  const auto seconds = object.find("seconds");
  if (seconds == object.end() || !seconds->is_number() || !(seconds->get<double>() > 0) ||
      !std::isfinite(seconds->get<double>()))
    return "'" + *id + "' needs a positive number 'seconds'";
  if (!stays_inside(*file) || !stays_inside(*labels)) return "'" + *id + "' names a file outside the folder";
  clip = {*id,      folder / *file, folder / *labels,       *language,
          *speaker, *style,         seconds->get<double>(), text_member(object, "transcript").value_or(""),
          *id};
  return std::nullopt;
}

}  // namespace

Result<std::vector<BenchmarkClip>> parse_benchmark(std::string_view json,
                                                   const std::filesystem::path& folder) {
  const auto fail = [&](const std::string& why) {
    return Error{Errc::input, "benchmark '" + folder.string() + "'", why,
                 "Give the folder that holds manifest.json"};
  };
  const nlohmann::json root =
      nlohmann::json::parse(json.begin(), json.end(), nullptr, /*allow_exceptions=*/false);
  if (root.is_discarded() || !root.is_object()) return fail("manifest.json is not a JSON object");
  const auto list = root.find("clips");
  if (list == root.end() || !list->is_array()) return fail("manifest.json has no array 'clips'");
  if (list->size() > kMaxClips) return fail("manifest.json lists more than 100000 clips");
  std::vector<BenchmarkClip> clips;
  std::set<std::string> ids;
  for (const nlohmann::json& object : *list) {
    BenchmarkClip clip;
    if (auto why = parse_clip(object, folder, clip))
      return fail("clip " + std::to_string(clips.size()) + " " + *why);
    if (!ids.insert(clip.id).second) return fail("clip id '" + clip.id + "' appears twice");
    clips.push_back(std::move(clip));
  }
  for (BenchmarkClip& clip : clips) {
    if (clip.style != "noisy" || !clip.id.ends_with(kNoisySuffix)) continue;
    const std::string clean = clip.id.substr(0, clip.id.size() - kNoisySuffix.size());
    if (ids.contains(clean)) clip.clean_id = clean;
  }
  return clips;
}

Result<std::vector<BenchmarkClip>> read_benchmark(const std::filesystem::path& folder) {
  MIEN_TRY(const Bytes bytes, read_file(folder / "manifest.json"));
  return parse_benchmark(as_text(bytes), folder);
}

Result<SpeechLabels> read_labels(const BenchmarkClip& clip) {
  MIEN_TRY(const Bytes bytes, read_file(clip.labels));
  return parse_speech_labels(as_text(bytes), clip.id);
}

std::string_view group_name(SpeechGroup group) {
  switch (group) {
    case SpeechGroup::english_clean:
      return "English clean";
    case SpeechGroup::noisy:
      return "noisy";
    case SpeechGroup::other_languages:
      return "other languages";
    case SpeechGroup::expressive:
      return "expressive";
  }
  return "";
}

bool belongs_to(const BenchmarkClip& clip, SpeechGroup group) {
  switch (group) {
    case SpeechGroup::english_clean:
      return clip.language == "en" && clip.style != "noisy";
    case SpeechGroup::noisy:
      return clip.style == "noisy";
    case SpeechGroup::other_languages:
      return clip.language != "en";
    case SpeechGroup::expressive:
      return clip.style == "expressive";
  }
  return false;
}

}  // namespace mien
