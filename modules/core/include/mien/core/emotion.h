#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace mien {

/// The eight emotions of the corpus (corpus specification, section 5); the order is part of the file formats.
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

}  // namespace mien
