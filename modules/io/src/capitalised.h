#pragma once
#include <cctype>
#include <string>

namespace mien::io {

/// With its first letter as a capital (ASCII).
inline std::string capitalised(std::string name) {
  if (!name.empty()) name[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(name[0])));
  return name;
}

}  // namespace mien::io
