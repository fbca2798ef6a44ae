#pragma once
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "mien/base/progress.h"
#include "mien/base/result.h"

namespace mien {

/// Curves u [T, K] that minimise
///
///   sum over frames n of  1/2 u_n^T P u_n + q_n^T u_n
///   subject to  lower <= u <= upper  and  |u_{n+1} - u_n| <= max_change, channel by channel
///
/// (SAiD, paper section 3.2; specification, section 10.4). All frames are solved together, so a limit on
/// the rate spreads a fast change over the frames before it too.
struct RateLimitedQp {
  std::int64_t num_channels = 0;      ///< K
  std::span<const double> quadratic;  ///< P [K, K] symmetric, positive definite
  std::span<const double> linear;     ///< q [T, K]
  double lower = 0, upper = 1;        ///< lower < upper
  double max_change = 0.1;            ///< per frame, > 0; infinity for none
};

struct QpSolution {
  std::vector<double> curves;  ///< u [T, K], within the limits but for rounding
  int num_iterations = 0;      ///< the most that a window took
  double stationarity = 0;     ///< largest |gradient of the Lagrangian|, relative to the mean diagonal of P
  double complementarity = 0;  ///< mean slack times multiplier, likewise
};

/// A primal-dual interior point method (interior_point.h) comes close, an active set method (active_set.h)
/// finishes to rounding. Both see a block-tridiagonal system whose off-diagonal blocks are diagonal
/// (frame_chain.h). Long sequences are solved in windows of 2048 frames that overlap by 256 and are joined
/// where both agree on what the limits of the rate carry, so that the whole fulfils the conditions of the
/// optimum; where limits reach across the whole overlap, windows are solved together. Time is linear in T;
/// beside input and result a window takes about 12 KB a frame for K = 32. The result does not depend on
/// anything but the input.
///
/// Errors: P is not positive definite or a value is not finite (Errc::input), cancelled.
/// @pre sizes agree, lower < upper, max_change > 0
Result<QpSolution> solve(const RateLimitedQp& problem, Progress& progress);

}  // namespace mien
