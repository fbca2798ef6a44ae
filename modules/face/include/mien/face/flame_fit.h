#pragma once
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "mien/base/progress.h"
#include "mien/base/result.h"
#include "mien/core/flame_model.h"
#include "mien/core/motion.h"

namespace mien {

struct FlameFitOptions {
  std::int64_t num_expressions = 50;  ///< the first of the model; ProbTalk3D has 50
  /// What an expression parameter of 1 costs: as much as all vertices that count lying this far off, in
  /// metres. It decides what the vertices leave open: expressions that look alike stay small.
  double expression_cost = 1e-5;
  int num_threads = 1;
};

struct FlameFitResult {
  Motion parameters;             ///< space `flame`: expression_0 ..., jaw_x, jaw_y, jaw_z
  std::vector<double> residual;  ///< [N] root mean square distance of the vertices that count, metres
  std::map<std::string, std::vector<double>> region_residual;  ///< the same over the vertices of each region
  int num_iterations = 0;                                      ///< the most that a frame took
};

/// FLAME's expression and jaw in a sequence of meshes of its topology. Each frame by itself, least squares:
///
///   minimise  sum over v | FLAME_v(expression, jaw) - p_v |^2  +  V expression_cost^2 | expression |^2
///
/// Shape and all other joints are 0. At a given jaw FLAME is linear in the expression (Li et al. 2017,
/// section 4; specification of ProbTalk3D, section 12.2), so Gauss-Newton steps in both, with the jaw's
/// rotation composed from the left, come to the minimum in a few steps from the face at rest. Where a step
/// does not lower the sum it is damped. There are no limits: ProbTalk3D's own range is not clipped either.
///
/// @param sequence  space `vertices` in metres, at the place of the model's neutral face
/// @param vertices  those that count; empty: all
/// @param regions   named lists of vertices of the model (Character::regions); only those that count are
/// looked at Errors: another number of vertices, more expressions than the model has (Errc::incompatible);
/// values that are not finite (Errc::input); cancelled. Bits do not depend on threads.
/// @pre sizes of the model fit each other, `vertices` lie within it, expression_cost > 0
Result<FlameFitResult> fit_flame(const FlameModel& model, const Motion& sequence,
                                 std::span<const std::uint32_t> vertices,
                                 const std::map<std::string, std::vector<std::uint32_t>>& regions,
                                 const FlameFitOptions& options, Progress& progress);

}  // namespace mien
