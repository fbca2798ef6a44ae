#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "mien/core/arkit.h"

namespace mien {

/// The eight emotions of the corpus (specification, section 5); the order is part of the file formats.
enum class Emotion : std::uint8_t { neutral, happy, sad, surprised, fear, disgusted, angry, contempt };
inline constexpr int kNumEmotions = 8;

/// "neutral" ... "contempt", indexed by the value of Emotion.
std::span<const std::string_view, kNumEmotions> emotion_names();
std::string_view name_of(Emotion emotion);
std::optional<Emotion> parse_emotion(std::string_view name);

/// Intensity of level 1, 2, 3: 0.35, 0.65, 1. Neutral has one level only; its intensity is 1 and has no
/// effect.
/// @pre level is 1, 2 or 3
float intensity_of_level(int level);

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
