#pragma once
#include <array>
#include <cmath>

#include "mien/models/default/network.h"

namespace mien::default_model {

/// What the blink path knows of earlier blinks: the class of the previous chunk (0 none, 1 + f onset in frame
/// f) and the time since the last onset.
class BlinkHistory {
 public:
  /// One-hot class of the previous chunk, then ln(1 + 0.2 chunks since the last onset).
  [[nodiscard]] std::array<float, kNumBlinkClasses + 1> numbers() const {
    std::array<float, kNumBlinkClasses + 1> out{};
    out[static_cast<std::size_t>(previous_)] = 1;
    out.back() = static_cast<float>(std::log1p(0.2 * since_));
    return out;
  }
  void add(int blink_class) {
    previous_ = blink_class;
    since_ = blink_class == 0 ? since_ + 1 : 0;
  }

 private:
  int previous_ = 0;
  int since_ = 8;  // at the start of a recording: as if 1.6 s had passed, about half a mean interval
};

}  // namespace mien::default_model
