#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mien/base/result.h"

namespace mien {

/// How much of a motion an edit keeps, by frame and channel.
struct MaskTable {
  std::vector<std::string> channels;  ///< [C] as the header spells them, each once
  std::vector<float> weights;         ///< [N, C]: 1 keep, 0 make anew, between them blend
};

/// Reads a mask (SAiD, section 1.2): a header of channel names, then a line of numbers from 0 to 1 per frame.
/// Columns named Timecode, BlendShapeCount or time, as recordings have them, are left out. Errors
/// (Errc::input), with the line: no header, a name twice, too few or too many fields, something that is no
/// number from 0 to 1.
Result<MaskTable> read_mask_csv(std::string_view text);

/// A value that was set by hand at an instant.
struct MotionKey {
  double seconds = 0;
  std::string channel;
  std::optional<float> value;  ///< nothing: what the motion has there
};

/// Reads keys: the header "time,channel,value", then a key a line, in any order; an empty value stands for
/// what the motion has there. Errors (Errc::input), with the line: another header, fields that are missing or
/// left over, a time that is no number of seconds from 0 on, a value that is not finite, no key at all.
Result<std::vector<MotionKey>> read_keys_csv(std::string_view text);

}  // namespace mien
