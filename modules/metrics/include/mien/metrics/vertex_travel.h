#pragma once
#include <vector>

#include "mien/base/result.h"
#include "mien/core/motion.h"

namespace mien {

/// How far each vertex moves from one frame to the next, over a sequence: the heat maps of ProbTalk3D (its
/// figures of motion mean and standard deviation). Units are those of the data, a frame.
struct VertexTravel {
  std::vector<float> mean;       ///< [V] of the N - 1 distances
  std::vector<float> deviation;  ///< [V] their standard deviation, divisor N - 1 (population)
};

/// Errors: Errc::incompatible for a motion that is not of vertices; Errc::input for fewer than two frames.
Result<VertexTravel> vertex_travel(const Motion& motion);

}  // namespace mien
