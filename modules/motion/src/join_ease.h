#pragma once
#include <span>

namespace mien {

/// What a channel may do beside a join. Second differences, a frame squared, at least 0:
struct EaseLimits {
  double at_kept = 0;                 ///< centred on the last kept value
  double at_free = 0;                 ///< centred on the first free one
  double elsewhere = 0;               ///< centred on the others, where they were not larger before
  std::span<const double> low, high;  ///< the values themselves, one limit for each
};

/// Eases a channel where it leaves what is kept. `values` are two kept ones, then at least two that may move,
/// then two that stay. The first two free values are put where both differences at the join keep their
/// limits; what follows moves by least squares, min |change|^2 + lambda sum of weighted squared second
/// differences, with the smallest lambda of a rising series for which all others keep theirs, or with the one
/// that comes nearest. Nothing moves where the differences at the join keep their limits.
/// @return how far a difference elsewhere is above its limit: more room is needed; 0 when none is
double ease_join(std::span<double> values, const EaseLimits& limits);

}  // namespace mien
