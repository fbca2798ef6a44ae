#pragma once
#include <span>
#include <string>
#include <string_view>

#include "mien/base/error.h"

namespace mien {

/// A program of its own that is reached as a sub-command.
struct Companion {
  std::string_view command, program, option, what;
};
std::span<const Companion> companions();

/// Becomes the companion program, which lies beside this one, with the arguments. Returns only when that
/// fails: it was not built, or cannot be started.
Error become(const Companion& companion, std::span<const std::string> arguments);

}  // namespace mien
