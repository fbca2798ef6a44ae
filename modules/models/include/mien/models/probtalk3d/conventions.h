#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "mien/models/model_file.h"

// What ProbTalk3D's programs fix outside of the networks: names, the range of the motion, the level of the
// sound.
namespace mien::probtalk3d {

inline constexpr std::int64_t kNumJaw =
    3;  ///< the last channels: the jaw's rotation as an axis times an angle
inline constexpr std::int64_t kNumExpression = 50, kNumHeads = 8;  ///< as published

/// In the order of their columns in a style: neutral, happy, sad, surprised, fear, disgusted, angry,
/// contempt.
std::vector<std::string> published_emotions();
/// low, medium, high: the levels 1, 2, 3 of MEAD.
std::vector<std::string> published_intensities();
/// The 32 training identities in the order of the published split.
std::vector<std::string> published_identities();

/// [identities | emotions | intensities], each with a 1 at its index. @pre indices within their counts
std::vector<float> style_weights(std::int64_t identity, std::int64_t num_identities, std::int64_t emotion,
                                 std::int64_t num_emotions, std::int64_t intensity,
                                 std::int64_t num_intensities);

/// Expression in -3 ... 3 and jaw in -0.1 ... 0.5 radians become 0 ... 1, without clipping: constants of the
/// published programs, not statistics of data.
ModelScaler published_scaler(std::int64_t num_channels = kNumExpression + kNumJaw);

/// In place: the clip moved and scaled to -1 ... 1, in float32 as the original. A constant clip becomes -1.
void stretch_waveform(std::span<float> samples);

}  // namespace mien::probtalk3d
