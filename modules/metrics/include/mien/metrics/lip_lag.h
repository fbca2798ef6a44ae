#pragma once
#include <span>

namespace mien {

/// Largest lag examined: half a second = 30 frames.
inline constexpr int kMaxLipLagFrames = 30;

/// Mien's own estimate of how far the lips are behind the sound, in the place of SyncNet's offset and
/// confidence, whose network the specification of SAiD does not describe; the numbers are not SyncNet's. Lip
/// opening and loudness, both smoothed over 30 ms, are correlated at every lag up to half a second, over the
/// same frames of sound.
struct LipLag {
  double lag_ms =
      0;  ///< of the largest correlation, between frames by a parabola; positive = the lips are late
  double peak_r = 0;      ///< the correlation there
  double confidence = 0;  ///< peak less the median over all lags, as SyncNet's is made of its distances
};

/// @param aperture  [N] lip opening at 60 frames/s (aperture.h)
/// @param level_db  [N'] speech_level_db() of the recording
/// NaN when fewer than 60 frames remain between the lags, or one of the two does not change.
LipLag lip_lag(std::span<const double> aperture, std::span<const double> level_db);

}  // namespace mien
