#pragma once
#include <array>
#include <string_view>

namespace mien::io {

/// The rotations of Live Link Face in the order of its columns; in a Motion they are degrees.
inline constexpr std::array<std::string_view, 9> kRotationNames = {
    "headYaw",     "headPitch",   "headRoll",      "leftEyeYaw",  "leftEyePitch",
    "leftEyeRoll", "rightEyeYaw", "rightEyePitch", "rightEyeRoll"};

}  // namespace mien::io
