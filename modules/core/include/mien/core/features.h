#pragma once
#include <cstdint>
#include <span>
#include <vector>

namespace mien {

/// Speech features over time: T frames of D numbers, row-major; frame t is centred on the instant t / frame_rate_hz.
struct Features {
  std::vector<float> values;  // [T, D]
  std::int64_t width = 0;     // D
  double frame_rate_hz = 0;

  [[nodiscard]] std::int64_t num_frames() const {
    return width == 0 ? 0 : static_cast<std::int64_t>(values.size()) / width;
  }
  [[nodiscard]] std::span<const float> frame(std::int64_t t) const {
    return std::span(values).subspan(static_cast<std::size_t>(t * width), static_cast<std::size_t>(width));
  }
};

}  // namespace mien
