#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace mien {

/// 95 % interval: the 2.5 and 97.5 percentiles of the draws. NaN when no draw gave a number.
struct Interval {
  double low = 0, high = 0;
};

/// Draws of recordings for intervals over speakers (human benchmark README, "Pooling and intervals"): each
/// draw takes as many speakers as there are, with replacement, then for every drawn speaker its recordings
/// with replacement. Two systems measured on the same recordings are compared with the same draws.
///
/// @param speakers  [I] the speaker of every recording
/// @return          [num_draws] indices into 0 ... I-1, equal for equal arguments on every machine
std::vector<std::vector<std::size_t>> speaker_draws(const std::vector<std::string>& speakers, int num_draws,
                                                    std::uint64_t seed);

/// NaN values are left out.
Interval interval_of(std::vector<double> draws);

inline constexpr int kDefaultDraws = 2000;

}  // namespace mien
