#pragma once
#include <cstdint>
#include <span>

namespace mien {

/// The face as the default model sees it: 45 numbers a frame instead of 52 ARKit coefficients and 3 head
/// angles. Left and right become half sum and half difference, so both eyes share one number; gaze becomes
/// two signed angles' worth of coefficients. jawLeft, jawRight, mouthLeft and mouthRight are always zero.
/// Lids are the position that gaze and expression imply: blinks are events on top (mien/motion/blink.h).
///
/// 0-13   lower pairs, (L+R)/2 then (L-R)/2: mouthSmile, Frown, Dimple, Stretch, Press, LowerDown, UpperUp
/// 14-24  jawForward, jawOpen, mouthClose, mouthFunnel, mouthPucker, mouthRollLower, mouthRollUpper,
/// mouthShrugLower,
///        mouthShrugUpper, cheekPuff, tongueOut
/// 25-38  upper pairs: eyeBlink, eyeSquint, eyeWide, browDown, browOuterUp, cheekSquint, noseSneer
/// 39-44  browInnerUp, gaze to the left, gaze up, headYaw, headPitch, headRoll (degrees)
inline constexpr std::int64_t kNumFace = 45;
inline constexpr std::int64_t kNumLower = 25;
inline constexpr std::int64_t kNumUpper = kNumFace - kNumLower;
inline constexpr std::int64_t kFacePress = 8;  ///< mouthPress, half sum
inline constexpr std::int64_t kFaceJawOpen = 15;
inline constexpr std::int64_t kFaceMouthClose = 16;

/// @param channels  [55] arkit_and_head_channels()
/// @param face      [45]
void encode_face(std::span<const float> channels, std::span<float> face);

/// The inverse, with ARKit coefficients clamped to [0, 1].
void decode_face(std::span<const float> face, std::span<float> channels);

}  // namespace mien
