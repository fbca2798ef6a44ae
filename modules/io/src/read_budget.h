#pragma once
#include <cstddef>

#include "mien/base/result.h"

namespace mien::io {

/// Limits what a file may ask for: a few bytes of JSON can name the same large accessor many times.
class ReadBudget {
 public:
  /// Errors (Errc::input): more than 50 million elements in all.
  Status spend(std::size_t elements) {
    if (elements > left_)
      return Error{Errc::input, "glTF",
                   "the file describes more than 50 million vertices, corners and offsets", ""};
    left_ -= elements;
    return Done{};
  }

 private:
  std::size_t left_ = 50'000'000;
};

}  // namespace mien::io
