#pragma once
#include <cstddef>
#include <span>
#include <string>

namespace mien {

/// What a file holds, guessed from its first bytes.
struct Sniffed {
  std::string what;           ///< "a PNG picture"; "unknown binary data" when nothing is recognised
  std::string fix;            ///< advice that goes with it; may be empty
  bool is_not_sound = false;  ///< certainly no sound: do not try to decode it
};

Sniffed sniff(std::span<const std::byte> head);

}  // namespace mien
