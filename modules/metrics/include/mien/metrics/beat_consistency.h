#pragma once
#include <span>
#include <vector>

#include "mien/metrics/frechet_distance.h"

namespace mien {

/// What beat consistency compares in one sequence.
struct BeatSequence {
  std::vector<double> audio_beats;  ///< seconds
  FeatureTable coefficients;        ///< [N, K]
};

struct BeatOptions {
  double fps = 60;
  double threshold = 0.1;  ///< of a kinematic beat
  double sigma = 0.1;      ///< seconds
};

/// Whether the motion slows down where the speech has its onsets (specification of SAiD, section 8.3; in the
/// authors' program, not in the paper). mac[k]: mean over sequences of the mean |difference between frames|
/// of channel k; rate[n]: mean over channels of |difference n| / mac; kinematic beats: smallest rates among
/// neighbours that lie more than `threshold` below one of the two, at n / fps. A sequence's score: mean over
/// its audio beats of exp(-d^2 / (2 sigma^2)), d the distance to the nearest kinematic beat; 0 without
/// kinematic beats. The mean over sequences, NaN when none has audio beats (those without are left out).
/// Channels that never move have no rate.
/// @pre all sequences have the same channels
double beat_consistency(std::span<const BeatSequence> sequences, const BeatOptions& options = {});

}  // namespace mien
