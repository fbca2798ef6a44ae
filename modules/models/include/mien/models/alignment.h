#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "mien/nn/operations.h"

namespace mien {

// How features at 50 Hz meet an animation at another rate, as FaceDiffuser and FaceXHuBERT do it.

inline constexpr double kSpeechFeatureHz = 50;

/// Frames that FaceDiffuser makes for `num_samples` at 16 kHz: trunc((S / 16000) fps) - 1, in double and in
/// this order; not negative.
[[nodiscard]] inline std::int64_t num_diffuser_frames(std::int64_t num_samples, double fps) {
  const double frames = (static_cast<double>(num_samples) / 16000.0) * fps;
  return std::max<std::int64_t>(0, static_cast<std::int64_t>(frames) - 1);
}

/// Which frames of features one frame of animation reads.
struct Alignment {
  std::int64_t num_frames = 0;    ///< N: what was asked for, or fewer when the speech is shorter
  std::int64_t group = 1;         ///< f: rows that stand side by side in a frame, [N, f H]
  std::int64_t used_rows = 0;     ///< without interpolation: rows read from the start, f N
  std::vector<double> positions;  ///< with interpolation: [f N] places between rows, ends on ends
};

/// 25 fps: pairs of features, an odd last one dropped; the animation is cut where the speech ends. Below 50
/// fps otherwise: all features stretched to f N rows, f = ceil(50 / fps). From 50 fps on: stretched to N
/// rows.
/// @param num_features  A rows at 50 Hz;  num_frames  N wanted
[[nodiscard]] inline Alignment align_features(std::int64_t num_features, std::int64_t num_frames,
                                              double fps) {
  Alignment a;
  if (fps * 2 == kSpeechFeatureHz) {
    a.group = 2;
    a.num_frames = std::min(num_frames, num_features / 2);
    a.used_rows = 2 * a.num_frames;
    return a;
  }
  a.num_frames = num_features > 0 ? num_frames : 0;
  a.group = fps < kSpeechFeatureHz ? static_cast<std::int64_t>(std::ceil(kSpeechFeatureHz / fps)) : 1;
  const std::int64_t rows = a.group * a.num_frames;
  // Places in float32, as the published programs have them.
  const float scale = rows > 1 ? static_cast<float>(num_features - 1) / static_cast<float>(rows - 1) : 0.0f;
  for (std::int64_t i = 0; i < rows; ++i)
    a.positions.push_back(static_cast<double>(scale * static_cast<float>(i)));
  return a;
}

/// features [.., A, H] -> [.., N, f H].
template <class T>
T aligned(const T& features, const Alignment& alignment) {
  using B = Operations<T>;
  return B::group_rows(alignment.positions.empty() ? B::rows(features, 0, alignment.used_rows)
                                                   : B::interpolate_rows(features, alignment.positions),
                       alignment.group);
}

}  // namespace mien
