#pragma once
#include <stdexcept>
#include <string>

namespace mien {

/// Throws std::logic_error when `holds` is false: a mistake of ours or of the calling program, never of the input.
/// Checked in every build, at room boundaries; use assert inside kernels.
inline void contract(bool holds, const char* message) {
  if (!holds) [[unlikely]]
    throw std::logic_error(message);
}
inline void contract(bool holds, const std::string& message) {
  if (!holds) [[unlikely]]
    throw std::logic_error(message);
}

}  // namespace mien
