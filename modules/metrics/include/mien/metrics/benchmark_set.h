#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "mien/base/result.h"
#include "mien/metrics/speech_labels.h"

namespace mien {

/// One recording of the human speech benchmark, as its manifest describes it.
struct BenchmarkClip {
  std::string id;
  std::filesystem::path audio;   ///< full path
  std::filesystem::path labels;  ///< full path
  std::string language;          ///< "en", "de", ...
  std::string speaker;
  std::string style;  ///< "read", "spontaneous", "expressive" or "noisy"
  double seconds = 0;
  std::string transcript;
  /// Id of the same recording without noise; the clip's own id when it is not a noisy copy. Loudness is taken
  /// from there.
  std::string clean_id;
};

/// The clips of `folder`/manifest.json in file order.
/// Errors (Errc::input): no or broken manifest, a clip without a member or with one of the wrong kind, a
/// repeated id, an audio or label path that leaves the folder, more than 100000 clips. Does not open the
/// recordings.
Result<std::vector<BenchmarkClip>> read_benchmark(const std::filesystem::path& folder);

/// The same from the text of a manifest; paths are put behind `folder`.
Result<std::vector<BenchmarkClip>> parse_benchmark(std::string_view json,
                                                   const std::filesystem::path& folder);

/// parse_speech_labels of the clip's label file.
Result<SpeechLabels> read_labels(const BenchmarkClip& clip);

/// The groups that are always reported apart (README of the benchmark, "Pooling and intervals").
enum class SpeechGroup { english_clean, noisy, other_languages, expressive };
inline constexpr SpeechGroup kSpeechGroups[] = {SpeechGroup::english_clean, SpeechGroup::noisy,
                                                SpeechGroup::other_languages, SpeechGroup::expressive};
std::string_view group_name(SpeechGroup group);
bool belongs_to(const BenchmarkClip& clip, SpeechGroup group);

}  // namespace mien
