#include "mien/core/emotion.h"

#include <algorithm>
#include <array>

#include "mien/base/contract.h"

namespace mien {
namespace {

constexpr std::array<std::string_view, kNumEmotions> kEmotionNames = {
    "neutral", "happy", "sad", "surprised", "fear", "disgusted", "angry", "contempt"};

}  // namespace

std::span<const std::string_view, kNumEmotions> emotion_names() { return kEmotionNames; }
std::string_view name_of(Emotion emotion) { return kEmotionNames[static_cast<std::size_t>(emotion)]; }

std::optional<Emotion> parse_emotion(std::string_view name) {
  const auto found = std::find(kEmotionNames.begin(), kEmotionNames.end(), name);
  if (found == kEmotionNames.end()) return std::nullopt;
  return static_cast<Emotion>(found - kEmotionNames.begin());
}

float intensity_of_level(int level) {
  contract(level >= 1 && level <= 3, "intensity_of_level: level must be 1, 2 or 3");
  return level == 1 ? 0.35f : level == 2 ? 0.65f : 1.0f;
}

}  // namespace mien
