#pragma once
#include <cstdint>
#include <span>

namespace mien::default_model {

/// What a frame's lips are corrected by (docs/default_model.md, section 6).
struct LipEvidence {
  float closed_probability = 0;  ///< of a bilabial, from the speech encoder, 0 ... 1
  float speech = 1;              ///< 0 in silence, 1 in speech
  float expression = 0;          ///< 0 neutral ... 1: how much of a pose the mouth may keep in silence
  float remaining = 1;           ///< falls to 0 at the last frame
};

/// Closes the lips where a bilabial is heard, rests them in silence, and shuts the mouth at the end.
/// @param face  [45] raw face numbers; the lower ones change
void correct_lips(const LipEvidence& evidence, std::span<float> face);

/// u^2 (3 - 2u) with u clamped to 0 ... 1.
float smooth_step(float u);

}  // namespace mien::default_model
