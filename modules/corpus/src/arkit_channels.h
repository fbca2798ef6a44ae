#pragma once
#include <algorithm>
#include <cstddef>

namespace mien {

/// Positions in arkit_names() that the generator writes. A name for both sides is the left one: add kLeft or
/// kRight.
namespace channel {
inline constexpr std::size_t kLeft = 0, kRight = 1;
inline constexpr std::size_t kJawForward = 14, kJawOpen = 17, kMouthClose = 18, kMouthFunnel = 19,
                             kMouthPucker = 20;
inline constexpr std::size_t kMouthSmile = 23, kMouthDimple = 27, kMouthStretch = 29, kMouthRollLower = 31;
inline constexpr std::size_t kMouthRollUpper = 32, kMouthShrugLower = 33, kMouthShrugUpper = 34,
                             kMouthPress = 35;
inline constexpr std::size_t kMouthLowerDown = 37, kMouthUpperUp = 39, kBrowDown = 41, kBrowInnerUp = 43;
inline constexpr std::size_t kBrowOuterUp = 44, kCheekPuff = 46, kCheekSquint = 47, kNoseSneer = 49,
                             kTongueOut = 51;
/// The eyes are stored as two blocks of seven: left 0-6, right 7-13. Add kRightEye for the right one.
inline constexpr std::size_t kEyeBlink = 0, kLookDown = 1, kLookIn = 2, kLookOut = 3, kLookUp = 4,
                             kEyeSquint = 5;
inline constexpr std::size_t kEyeWide = 6, kRightEye = 7;
}  // namespace channel

/// mouthClose that seals lips parted by jawOpen: min(1, LC jawOpen + 0.02 LC) (specification, 4.3).
inline float mouth_close(float closure, float jaw_open) {
  return std::min(1.0f, closure * jaw_open + 0.02f * closure);
}

}  // namespace mien
