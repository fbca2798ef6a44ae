#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "mien/base/result.h"
#include "mien/corpus/viseme.h"

namespace mien {

/// What a prepared training set holds, measured from its tensors.
struct SetStatistics {
  std::string description;  ///< metadata "mien.set"
  std::int64_t entries = 0, takes = 0, valid_entries = 0;
  double hours = 0;
  double shortest_s = 0, longest_s = 0;
  float mel_min = 0, mel_max = 0, level_min = 0, level_max = 0;
  float curve_min = 0, curve_max = 0;  ///< of the 52 coefficients
  float head_max_deg = 0;              ///< largest absolute head angle
  double blinks_per_minute = 0, raises_per_minute = 0;
  double accents_per_second = 0;  ///< of speech without pauses
  double pause_share = 0;         ///< frames of viseme sil
  std::array<std::int64_t, 8> entries_by_emotion{};
  std::array<double, kNumVisemes> frames_by_viseme{}, jaw_by_viseme{};  ///< share of frames; mean jawOpen
  std::int64_t closures = 0;                                            ///< runs of the closure tensor
  double closure_dip = 0;   ///< mel bands 9-48 in closures minus 0.1 s around them, ln-power units
  double sealed_share = 0;  ///< closures in which jawOpen - mouthClose falls below 0.04, all takes
};

/// Reads a whole set and measures it. Errors (Errc::input, Errc::incompatible): not such a file, tensors that
/// disagree in length, offsets that do not rise, values that are not finite or outside of their range - each
/// named with its place.
Result<SetStatistics> check_set(const std::filesystem::path& path);

/// The statistics in lines for people.
std::string to_text(const SetStatistics& statistics);

}  // namespace mien
