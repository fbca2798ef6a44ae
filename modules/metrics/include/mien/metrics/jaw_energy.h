#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "mien/metrics/speech_labels.h"

namespace mien {

/// Largest lag examined: 100 ms = 6 frames.
inline constexpr int kMaxJawLagFrames = 6;

/// Correlation of the jaw with the loudness of one recording (human benchmark README, "Jaw-energy
/// correlation"): a check of plausibility, good between about 0.5 and 0.85; a face driven by loudness alone
/// scores 1.
struct JawEnergy {
  /// r at lag -6 ... +6 frames; positive = the jaw follows the sound. NaN when undefined.
  std::array<double, 2 * kMaxJawLagFrames + 1> r_at_lag{};
  std::int64_t frames = 0;  ///< scored at lag 0: the weight in the average

  [[nodiscard]] double r() const { return r_at_lag[kMaxJawLagFrames]; }
};

/// @param jaw       [N] jawOpen (mesh: chin displacement or lip gap) at 60 frames/s; smoothed here
/// @param level_db  [N'] speech_level_db() of the recording, for a noisy one of its clean copy; already
/// smoothed
JawEnergy jaw_energy(std::span<const double> jaw, std::span<const double> level_db,
                     const SpeechLabels& labels);

/// Average over recordings by Fisher z weighted with frames, at every lag.
struct PooledJawEnergy {
  double r = 0;       ///< at lag 0
  double lag_ms = 0;  ///< where the pooled r is largest
};
PooledJawEnergy pool_jaw_energy(std::span<const JawEnergy> clips);

}  // namespace mien
