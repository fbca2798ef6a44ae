#pragma once
#include <string>
#include <string_view>

#include "mien/base/result.h"
#include "mien/core/motion.h"
#include "mien/io/text_sink.h"

namespace mien {

/// Writes FLAME parameters as CSV: a header "time" and the channels' names, then a row per frame: seconds,
/// and numbers that read back as the same floats. Errors: Errc::incompatible for motion of another space,
/// Errc::failed for numbers that are not finite.
Status write_flame_csv(const Motion& motion, const TextSink& sink);

/// True when the header of a CSV names a FLAME parameter.
bool is_flame_csv(std::string_view text);
/// Reads that. `fps`: of the motion; 0: from the times, 25 where there is one row. Errors (Errc::input): a
/// column that is no parameter or comes twice, a row with too few or too many fields, fields that are no
/// finite numbers, times that do not rise evenly.
Result<Motion> read_flame_csv(std::string_view text, double fps = 0);

}  // namespace mien
