#pragma once
#include <string>
#include <string_view>

namespace mien {

/// Class of a failure. The program's exit codes follow from it (see docs/formats.md).
enum class Errc {
  failed,        ///< the work itself failed: exit code 1
  usage,         ///< wrong option or value: exit code 2
  input,         ///< an input is missing or unreadable: exit code 3
  incompatible,  ///< model, character and input do not fit together: exit code 4
  cancelled,     ///< the user interrupted: exit code 130
};

/// A failure of the world (files, weights, audio, options). Our own mistakes throw instead, see contract.h.
struct Error {
  Errc code = Errc::failed;
  std::string what;  ///< the thing that failed, by name: file, tensor, option
  std::string why;   ///< expected against found, with numbers and units
  std::string fix;   ///< the next thing to try; empty when there is none

  /// One line: "what: why. fix".
  [[nodiscard]] std::string message() const {
    std::string m = what.empty() ? why : what + ": " + why;
    if (!fix.empty()) m += ". " + fix;
    return m;
  }
};

/// The same error seen from one level up, e.g. within(error, "loading model 'a.safetensors'").
[[nodiscard]] inline Error within(Error error, std::string_view outer) {
  error.what = error.what.empty() ? std::string(outer) : std::string(outer) + ": " + error.what;
  return error;
}

}  // namespace mien
