#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mien/base/result.h"

namespace mien {

/// Lips-together window of a bilabial, seconds.
struct ClosureWindow {
  double start = 0, end = 0;

  [[nodiscard]] double centre() const { return (start + end) / 2; }
};

/// What is said about a row of phone labels, as bits.
enum LabelFlag : std::uint32_t {
  kEdgeStart = 1u << 0,  ///< touches a silence: that end of the closure cannot be heard
  kEdgeEnd = 1u << 1,
  kClusterStart = 1u << 2,  ///< neighbour is t d k g n ng: that end rests on the aligner only
  kClusterEnd = 1u << 3,
  kMerged = 1u << 4,        ///< bilabials follow each other: one closure, the same window repeated
  kSameEvent = 1u << 5,     ///< the repeated row of a merged group
  kDoubtful = 1u << 6,      ///< no acoustic support: not scored
  kDtwDisagrees = 1u << 7,  ///< information only
  kNotQuiet = 1u << 8,      ///< a pause with noise, breath or a voice in it
};

/// One phone of a recording: [start, end) in seconds.
struct PhoneRow {
  double start = 0, end = 0;
  std::string phone;   ///< ARPABET lower case; "sil" = pause of at least 0.3 s, "sp" = shorter silence
  std::string viseme;  ///< class of the corpus; diphthongs as two joined by '+'
  std::optional<ClosureWindow> closure;
  double confidence = 0;  ///< 0 ... 1
  std::uint32_t flags = 0;

  [[nodiscard]] bool is_silence() const { return phone == "sil" || phone == "sp"; }
};

/// The phones of one recording; contiguous rows that cover it.
struct SpeechLabels {
  std::vector<PhoneRow> rows;

  [[nodiscard]] double seconds() const { return rows.empty() ? 0 : rows.back().end; }
  /// Row index of every frame n / fps; frames past the end belong to the last row. Empty when there are no
  /// rows.
  [[nodiscard]] std::vector<std::size_t> rows_of_frames(std::int64_t num_frames, double fps) const;
};

/// Reads the label table of the human speech benchmark (its README, "Content"): tab-separated, header line
/// "start end phone viseme closure_start closure_end confidence flags", '-' for nothing.
/// Errors (Errc::input), each naming the line: no header, wrong number of columns, a time that is no number
/// or not finite, rows that overlap, leave a gap or run backwards, unknown flag, more than 1e6 rows. A
/// closure window that ends before it starts is a warning (one of the doubtful labels of the benchmark is
/// such).
Result<SpeechLabels> parse_speech_labels(std::string_view text, std::string_view name);

}  // namespace mien
