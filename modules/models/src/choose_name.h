#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "mien/base/result.h"

namespace mien {

/// Index of `wanted` in `names`, or `by_default` when nothing is wanted. Error (Errc::usage): an unknown
/// name, with the list; a name where there is no choice.
Result<std::int64_t> choose_name(const std::string& option, const std::string& wanted,
                                 const std::vector<std::string>& names, std::size_t by_default);

}  // namespace mien
