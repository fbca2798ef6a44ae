#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "mien/models/model_file.h"

namespace mien {

/// Names of the style columns: those given, else those of the published checkpoints, else numbers with a
/// warning. Errors (Errc::usage): another number of names than columns, or names where there are no styles.
Result<std::vector<std::string>> subject_names(const std::vector<std::string>& given, std::int64_t count,
                                               Architecture architecture, const std::string& topology);

}  // namespace mien
