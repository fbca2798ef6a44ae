#pragma once
#include <vector>

#include "frame_chain.h"
#include "scaled_qp.h"

namespace mien {

struct PolishedPoint {
  std::vector<double> x;
  std::vector<double>
      pair_pull;            ///< multipliers of rising less those of falling changes; empty without limits
  double stationarity = 0;  ///< largest |gradient of the Lagrangian|
  double violation = 0;     ///< farthest that a limit is broken, or a multiplier below zero
  int num_rounds = 0;
};

/// From a point near the optimum to the optimum itself, to rounding: which limits hold is taken from the
/// point (a multiplier above its slack), the problem with these as equations is solved by the method of
/// multipliers (one factor, a few solves), and limits that turn out broken or pulling the wrong way change
/// sides, until none does (a primal-dual active set method: Hintermueller, Ito and Kunisch 2003). An interior
/// point method alone loses digits of its normal equations before limits that barely hold are known.
///
/// @param x, multipliers  of an interior point @param solved  receives the result
/// False when the sides did not settle; the interior point must then come closer first.
[[nodiscard]] bool polish(const ScaledQp& problem, FrameChain& chain, const std::vector<double>& x,
                          const Multipliers& multipliers, PolishedPoint& solved);

}  // namespace mien
