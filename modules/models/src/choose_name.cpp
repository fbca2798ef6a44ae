#include "choose_name.h"

#include <algorithm>

namespace mien {

Result<std::int64_t> choose_name(const std::string& option, const std::string& wanted,
                                 const std::vector<std::string>& names, std::size_t by_default) {
  if (names.empty()) {
    if (wanted.empty()) return std::int64_t{0};
    return Error{Errc::usage, option + " '" + wanted + "'", "the model has no such choice",
                 "Leave the option out"};
  }
  if (wanted.empty()) return static_cast<std::int64_t>(by_default);
  const auto found = std::find(names.begin(), names.end(), wanted);
  if (found != names.end()) return static_cast<std::int64_t>(found - names.begin());
  std::string list;
  for (const auto& name : names) list += (list.empty() ? "" : ", ") + name;
  return Error{Errc::usage, option + " '" + wanted + "'", "the model does not know it", "It knows: " + list};
}

}  // namespace mien
