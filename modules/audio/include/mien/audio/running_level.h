#pragma once
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "mien/audio/log_mel.h"

namespace mien {

/// Level of speech at RMS 0.06: 95th percentile over frames of the mean over bands, in ln-power units.
/// Measured as the mean over 18 clean utterances in 11 languages, each scaled to that RMS; a test repeats the
/// measurement. (The 81 clips of the human speech benchmark lie between -3.8 and -0.4, mean -2.0: all above
/// kLevelFloor.)
inline constexpr float kSpeechLevel = -2.89f;

/// Sound more than 9 dB below kSpeechLevel is not lifted any further, so that silence stays silence
/// (default model specification, section 4.4; one dB is ln(10)/10 in these units).
inline constexpr float kLevelFloor = kSpeechLevel - 0.9f * std::numbers::ln10_v<float>;

/// Frames over which the running level looks back (4 s).
inline constexpr int kLevelWindow = 400;

/// Mean over bands of one log-mel frame, ln-power units.
float frame_level(std::span<const float, kNumMelBands> log_mel_frame);

/// Loudness of speech so far: max(95th percentile of frame_level over the last 400 frames, kLevelFloor). The
/// percentile of n values lies at position 0.95 (n - 1) of the sorted values, linearly interpolated. It looks
/// only backwards, so streaming and offline agree bit for bit.
class RunningLevel {
 public:
  RunningLevel();
  /// The level after this frame.   @pre the frame is finite
  float push(std::span<const float, kNumMelBands> log_mel_frame);

 private:
  std::vector<float> recent_;  // ring of the last kLevelWindow frame levels
  std::vector<float> sorted_;  // the same values, ascending
  std::size_t next_ = 0;       // place in recent_ of the next value once it is full
};

/// RunningLevel over all frames: [T].   @pre features.width == kNumMelBands
std::vector<float> running_levels(const Features& log_mel);

/// What the networks take in: (max(log_mel - level, -14) + 5) / 3.5 (corpus specification, section 14).
inline float normalise_mel(float log_mel, float level) {
  return (std::fmax(log_mel - level, -14.0f) + 5.0f) / 3.5f;
}
/// The same for a frame; `out` may be the frame itself.
void normalise_mel(std::span<const float, kNumMelBands> log_mel_frame, float level,
                   std::span<float, kNumMelBands> out);

}  // namespace mien
