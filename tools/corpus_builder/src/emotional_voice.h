#pragma once
#include <vector>

#include "engine.h"
#include "mien/corpus/emotion.h"

namespace mien {

/// The way of speaking under an emotion: rate, pitch and range of the corpus' prosody (spec section 5).
Speaking with_emotion(Speaking speaking, Emotion emotion, double intensity);

/// The part of the prosody that no engine offers: tremor, tilt and level, applied to the sound (16 kHz).
void color_with_emotion(std::vector<float>& samples, Emotion emotion, double intensity);

}  // namespace mien
