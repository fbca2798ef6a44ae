#include "mien/metrics/vertex_travel.h"

#include <algorithm>
#include <cmath>

namespace mien {

Result<VertexTravel> vertex_travel(const Motion& motion) {
  if (motion.space != MotionSpace::vertices)
    return Error{Errc::incompatible, "motion", "is not one of vertices", "Put it on a mesh with mien render"};
  const std::int64_t num_pairs = motion.num_frames() - 1;
  if (num_pairs < 1)
    return Error{Errc::input, "motion",
                 "has " + std::to_string(motion.num_frames()) + " frames; travel needs two", ""};
  const auto count = static_cast<std::size_t>(motion.topology.num_vertices);
  std::vector<double> sum(count), squares(count);
  for (std::int64_t n = 0; n < num_pairs; ++n) {
    const auto before = motion.frame(n), after = motion.frame(n + 1);
    for (std::size_t v = 0; v < count; ++v) {
      double square = 0;
      for (std::size_t k = 3 * v; k < 3 * v + 3; ++k) {
        const double step = static_cast<double>(after[k]) - static_cast<double>(before[k]);
        square += step * step;
      }
      sum[v] += std::sqrt(square);
      squares[v] += square;
    }
  }
  VertexTravel travel{std::vector<float>(count), std::vector<float>(count)};
  const auto pairs = static_cast<double>(num_pairs);
  for (std::size_t v = 0; v < count; ++v) {
    const double mean = sum[v] / pairs;
    travel.mean[v] = static_cast<float>(mean);
    travel.deviation[v] = static_cast<float>(std::sqrt(std::max(0.0, squares[v] / pairs - mean * mean)));
  }
  return travel;
}

}  // namespace mien
