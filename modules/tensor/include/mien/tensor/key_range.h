#pragma once
#include <cstdint>

namespace mien {

/// The keys that one query of an attention sees: first, first + 1 ... end - 1.
struct KeyRange {
  std::int64_t first = 0, end = 0;

  friend bool operator==(const KeyRange&, const KeyRange&) = default;
};

}  // namespace mien
