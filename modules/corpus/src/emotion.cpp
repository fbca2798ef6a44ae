#include "mien/corpus/emotion.h"

#include <algorithm>
#include <string>

#include "mien/base/contract.h"

namespace mien {
namespace {

// A name without Left or Right applies to both sides.
struct PoseEntry {
  std::string_view name;
  float value;
};

ArkitFrame pose_of(std::initializer_list<PoseEntry> entries) {
  const auto names = arkit_names();
  ArkitFrame pose{};
  for (const auto& [name, value] : entries) {
    if (std::find(names.begin(), names.end(), name) != names.end()) {
      pose[arkit_index(name)] = value;
      continue;
    }
    pose[arkit_index(std::string(name) + "Left")] = value;
    pose[arkit_index(std::string(name) + "Right")] = value;
  }
  return pose;
}

constexpr std::array<EmotionGains, kNumEmotions> kGains = {{
    {1.00, 1.00, 1.00, 1.00, 1.00},  // neutral
    {1.08, 1.10, 0.85, 1.20, 1.15},  // happy
    {0.75, 0.80, 1.00, 0.80, 0.80},  // sad
    {1.20, 1.10, 1.00, 1.00, 0.60},  // surprised
    {1.00, 1.05, 0.90, 1.15, 1.40},  // fear
    {0.90, 1.00, 0.95, 1.05, 1.00},  // disgusted
    {1.18, 1.25, 1.05, 1.10, 0.70},  // angry
    {0.85, 0.90, 0.95, 1.00, 0.80},  // contempt
}};

}  // namespace

const ArkitFrame& apex_pose(Emotion emotion) {
  static const std::array<ArkitFrame, kNumEmotions> poses = {pose_of({}),
                                                             pose_of({{"mouthSmile", 0.75f},
                                                                      {"cheekSquint", 0.60f},
                                                                      {"eyeSquint", 0.35f},
                                                                      {"mouthDimple", 0.15f},
                                                                      {"browOuterUp", 0.08f},
                                                                      {"browInnerUp", 0.05f},
                                                                      {"mouthUpperUp", 0.10f},
                                                                      {"mouthStretch", 0.05f}}),
                                                             pose_of({{"browInnerUp", 0.70f},
                                                                      {"browDown", 0.22f},
                                                                      {"mouthFrown", 0.60f},
                                                                      {"mouthShrugLower", 0.30f},
                                                                      {"eyeSquint", 0.18f},
                                                                      {"eyeBlink", 0.12f},
                                                                      {"eyeLookDown", 0.12f},
                                                                      {"mouthPress", 0.08f},
                                                                      {"mouthRollLower", 0.06f}}),
                                                             pose_of({{"browInnerUp", 0.75f},
                                                                      {"browOuterUp", 0.75f},
                                                                      {"eyeWide", 0.70f},
                                                                      {"jawOpen", 0.16f},
                                                                      {"mouthFunnel", 0.10f}}),
                                                             pose_of({{"browInnerUp", 0.70f},
                                                                      {"browOuterUp", 0.35f},
                                                                      {"browDown", 0.28f},
                                                                      {"eyeWide", 0.60f},
                                                                      {"eyeSquint", 0.10f},
                                                                      {"mouthStretch", 0.45f},
                                                                      {"jawOpen", 0.08f},
                                                                      {"mouthFrown", 0.12f},
                                                                      {"mouthLowerDown", 0.12f}}),
                                                             pose_of({{"noseSneer", 0.70f},
                                                                      {"mouthUpperUp", 0.42f},
                                                                      {"browDown", 0.35f},
                                                                      {"cheekSquint", 0.30f},
                                                                      {"eyeSquint", 0.30f},
                                                                      {"mouthFrown", 0.28f},
                                                                      {"mouthShrugLower", 0.20f},
                                                                      {"mouthLowerDown", 0.08f}}),
                                                             pose_of({{"browDown", 0.80f},
                                                                      {"eyeSquint", 0.40f},
                                                                      {"eyeWide", 0.18f},
                                                                      {"noseSneer", 0.30f},
                                                                      {"mouthPress", 0.30f},
                                                                      {"jawForward", 0.15f},
                                                                      {"mouthFrown", 0.22f},
                                                                      {"mouthRollLower", 0.10f},
                                                                      {"mouthShrugLower", 0.15f}}),
                                                             pose_of({{"mouthDimpleRight", 0.45f},
                                                                      {"mouthSmileRight", 0.40f},
                                                                      {"mouthDimpleLeft", 0.05f},
                                                                      {"mouthSmileLeft", 0.04f},
                                                                      {"eyeSquint", 0.15f},
                                                                      {"browDownLeft", 0.12f},
                                                                      {"browOuterUpRight", 0.18f},
                                                                      {"mouthPress", 0.14f},
                                                                      {"cheekSquintRight", 0.15f}})};
  return poses[static_cast<std::size_t>(emotion)];
}

ArkitFrame mirrored(const ArkitFrame& frame) {
  static const auto partner = [] {
    const auto names = arkit_names();
    std::array<std::size_t, kNumArkit> p{};
    for (std::size_t c = 0; c < kNumArkit; ++c) {
      std::string name(names[c]);
      if (name.ends_with("Left"))
        name.replace(name.size() - 4, 4, "Right");
      else if (name.ends_with("Right"))
        name.replace(name.size() - 5, 5, "Left");
      p[c] = arkit_index(name);
    }
    return p;
  }();
  ArkitFrame out{};
  for (std::size_t c = 0; c < kNumArkit; ++c) out[c] = frame[partner[c]];
  return out;
}

const EmotionGains& emotion_gains(Emotion emotion) { return kGains[static_cast<std::size_t>(emotion)]; }

}  // namespace mien
