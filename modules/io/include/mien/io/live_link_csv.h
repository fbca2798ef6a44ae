#pragma once
#include <string>
#include <string_view>

#include "mien/base/result.h"
#include "mien/core/motion.h"
#include "mien/io/text_sink.h"

namespace mien {

/// Writes ARKit motion as Live Link Face CSV: Timecode, BlendShapeCount (61), the 52 names in the order of
/// the app and the nine rotations of head and eyes in radians. Channels that the motion lacks are 0, others
/// than these are left out with a warning. Rows start at 00:00:00:00.000; the frame part counts at the rate
/// of the motion. Eight decimals, dot,
/// "\n".
/// Errors: Errc::incompatible for motion that is not ARKit coefficients, Errc::failed for numbers that are
/// not finite.
Status write_live_link_csv(const Motion& motion, const TextSink& sink);
/// The same as one text.
Result<std::string> live_link_csv(const Motion& motion);

struct CsvReadOptions {
  /// Rate of the motion, and of the frame part of its timecodes unless that counts higher; 0 = found from the
  /// rows.
  double fps = 0;
};

/// Reads coefficients from CSV by column name: Live Link Face recordings, Audio2Face exports (time in
/// seconds, prefix "blendShapes."), files with names alone (SAiD; the rate is the option's or 60). Spellings
/// as match_arkit_name().
///
/// Channels of the result: ARKit names in their order, then head_names() in degrees and leftEyeYaw ...
/// rightEyeRoll in degrees where the file has such columns and they are not all zero. Rotations are radians,
/// unless one is above 2. Time zero is the first row. Timecodes may pass midnight. Instants without a row are
/// interpolated; rows that go back in time, and rows without a face (BlendShapeCount 0), are left out with a
/// warning.
///
/// Rate: for timecodes, the lowest usual rate that holds the largest frame number, divided by the usual step
/// between rows (60 for recordings shorter than a second); for seconds, the average, brought to a usual rate
/// within 0.05 %.
///
/// Errors (Errc::input): no header, a row with too few or too many fields, fields that are no numbers, gaps
/// of hours; (Errc::incompatible): no column with an ARKit name.
Result<Motion> read_live_link_csv(std::string_view text, const CsvReadOptions& options = {});

}  // namespace mien
