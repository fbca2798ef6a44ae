#pragma once
#include "mien/corpus/emotion.h"

namespace mien {

/// How an emotion changes the voice, given to the synthesiser (specification, section 5).
struct Prosody {
  double pitch_percent = 0;  ///< change of the mean F0
  double pitch_range = 1;    ///< factor on the F0 range
  double rate_percent = 0;   ///< change of the speaking rate
  double level_db = 0;
  double tilt_db = 0;         ///< first-order high shelf at 1.5 kHz
  double tremor_percent = 0;  ///< depth of a 5 Hz F0 tremor
};

/// Linear between neutral and the table at intensity 1.
Prosody prosody_of(Emotion emotion, double intensity);

}  // namespace mien
