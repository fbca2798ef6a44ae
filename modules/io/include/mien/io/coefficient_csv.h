#pragma once
#include "mien/base/result.h"
#include "mien/core/motion.h"
#include "mien/io/text_sink.h"

namespace mien {

/// Writes coefficients as SAiD's programs do (a table of the pandas library): the 32 names of
/// ArkitOrder::said, then a line per frame, without times; numbers are the shortest text that reads back as
/// the same float32. Channels that the motion lacks are 0. Those programs read columns by their place, so the
/// order is fixed; ours read by name (read_motion()). Warnings: channels without a column; a rate other than
/// the 60 frames a second that those programs assume. Errors: as write_live_link_csv().
Status write_coefficient_csv(const Motion& motion, const TextSink& sink);

}  // namespace mien
