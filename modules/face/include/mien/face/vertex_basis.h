#pragma once
#include <cstdint>
#include <vector>

#include "mien/base/progress.h"
#include "mien/base/result.h"
#include "mien/core/blendshape_rig.h"
#include "mien/core/motion.h"

namespace mien {

struct VertexBasisOptions {
  double max_error =
      0;  ///< farthest that any vertex may lie from its place in any frame; units of the motion
  std::int64_t max_shapes = 512;  ///< the error is what it is when these do not reach it
  int num_threads = 1;            ///< the result is the same for any number
};

/// A sequence of meshes as blendshapes: frame n = neutral + sum over k of coefficients[n, k] shapes[k].
struct VertexBasis {
  std::vector<Vec3> neutral;       // [V] the mean of the frames
  std::vector<Blendshape> shapes;  // [K] "shape000" ..., all vertices, at least one shape
  Motion coefficients;             // [N, K] space `rig`, channels named as the shapes, within [-1, 1]
  double max_error = 0;            ///< measured on the stored numbers: farthest vertex of all frames
  double rms_error = 0;            ///< root mean square distance over vertices and frames
};

/// Principal components of the sequence, as many as the error needs. The components come from at most 256
/// evenly spread frames (an eigenproblem of their inner products); where these leave an error, the worst
/// frame's remainder becomes the next shape, so that any error above rounding is reached.
///
/// Memory: one copy of the sequence. Warning: max_shapes did not reach max_error.
/// Errors: Errc::input for a motion without frames or with numbers that are not finite; Errc::cancelled.
/// @pre space `vertices`, max_error > 0, max_shapes > 0
Result<VertexBasis> vertex_basis(const Motion& motion, const VertexBasisOptions& options, Progress& progress);

}  // namespace mien
