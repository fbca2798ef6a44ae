#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mien::io {

/// HH:MM:SS:FF.sss; the frame part counts at a rate that the file does not state.
struct Timecode {
  double whole_seconds = 0;  ///< 3600 HH + 60 MM + SS
  double frames = 0;         ///< FF.sss
};

/// Nothing when the text is no timecode. ';' before the frames (drop-frame notation) counts as ':'.
std::optional<Timecode> parse_timecode(std::string_view text);

/// Timecode of frame n: the instant n / fps.
std::string timecode_text(std::int64_t n, double fps);

/// The lowest usual rate at which such frame numbers can occur; 60 when the rows stay within one second.
double timecode_rate(const std::vector<Timecode>& rows);

/// Whether such frame numbers can occur at a rate: they are below it, rounded up (29.97 counts to 29).
bool can_count_at(double fps, const std::vector<Timecode>& rows);

/// A rate near to `fps` that is in use (24, 25, 29.97 ...) or whole, within 0.05 %; else fps itself.
double usual_rate(double fps);

}  // namespace mien::io
