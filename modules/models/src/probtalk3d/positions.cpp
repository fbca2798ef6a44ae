#include "mien/models/probtalk3d/positions.h"

#include <cmath>

namespace mien::probtalk3d {

std::vector<float> position_table(std::int64_t num_frames, std::int64_t width) {
  std::vector<float> table(static_cast<std::size_t>(num_frames * width));
  const auto rate = static_cast<float>(-std::log(10000.0) / static_cast<double>(width));
  for (std::int64_t i = 0; i < width; ++i) {
    const float w = std::exp(static_cast<float>(i / 2 * 2) * rate);
    for (std::int64_t t = 0; t < num_frames; ++t) {
      const float angle = static_cast<float>(t) * w;
      table[static_cast<std::size_t>(t * width + i)] = i % 2 == 0 ? std::sin(angle) : std::cos(angle);
    }
  }
  return table;
}

}  // namespace mien::probtalk3d
