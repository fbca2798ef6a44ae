#pragma once
#include <functional>
#include <string_view>

#include "mien/base/result.h"

namespace mien {

/// Where a writer sends its text, piece by piece, so that hours of motion never stand in memory as text. An
/// error ends the writing and is returned by the writer.
using TextSink = std::function<Status(std::string_view)>;

}  // namespace mien
