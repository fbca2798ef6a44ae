#pragma once
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "mien/base/progress.h"
#include "mien/base/result.h"
#include "mien/core/blendshape_rig.h"
#include "mien/core/motion.h"

namespace mien {

struct FitOptions {
  double lower = 0, upper = 1;  ///< limits of every coefficient
  double max_change = 0.1;      ///< from frame to frame, at the rate of the sequence; infinity for none
  int num_threads = 1;
};

/// Named vertex lists whose residual is reported apart (Character::regions).
using FitRegions = std::map<std::string, std::vector<std::uint32_t>>;

struct FitResult {
  Motion coefficients;           ///< space arkit, one channel a shape
  std::vector<double> residual;  ///< [N] root mean square distance of the vertices, in the unit of the meshes
  std::map<std::string, std::vector<double>> region_residual;  ///< the same over the vertices of each region
  int num_iterations = 0;
};

/// Coefficients whose shapes come closest to a sequence of meshes: least squares over all frames together,
/// within the limits (SAiD, paper section 3.2).
///
/// @param sequence  space `vertices` with as many vertices as the neutral face, in its order, unit and place
/// Errors: another number of vertices (Errc::incompatible), values that are not finite or shapes that do not
/// decide the coefficients (Errc::input), cancelled.
/// @pre at least one shape; their vertex indices lie within the neutral face
Result<FitResult> fit_coefficients(std::span<const Vec3> neutral, std::span<const Blendshape> shapes,
                                   const Motion& sequence, const FitRegions& regions,
                                   const FitOptions& options, Progress& progress);

}  // namespace mien
