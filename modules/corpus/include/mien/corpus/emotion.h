#pragma once
#include <array>
#include <cstdint>

#include "mien/core/arkit.h"
#include "mien/core/emotion.h"

namespace mien {

/// ARKit coefficients of a whole face, in the order of arkit_names().
using ArkitFrame = std::array<float, kNumArkit>;

/// Apex pose of an emotion at intensity 1, with contempt on the right.
const ArkitFrame& apex_pose(Emotion emotion);

/// Left and right exchanged.
ArkitFrame mirrored(const ArkitFrame& frame);

/// How an emotion changes articulation and blinking, at intensity 1: interpolate with scaled_gain.
struct EmotionGains {
  double jaw, lip, round, spread;
  double blink_rate;
};
const EmotionGains& emotion_gains(Emotion emotion);

/// Gain at an intensity: 1 + (gain - 1) * intensity.
constexpr double scaled_gain(double gain, double intensity) { return 1 + (gain - 1) * intensity; }

}  // namespace mien
