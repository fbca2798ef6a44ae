#pragma once
#include <string>
#include <vector>

#include "engine.h"
#include "mien/corpus/emotion.h"
#include "mien/corpus/performance.h"

namespace mien {

/// Sound at 16 kHz and what is said in it, of exactly the same duration.
struct Clip {
  std::vector<float> samples;
  Utterance spoken;
  std::size_t num_sentences = 0;
};

struct ClipRequest {
  EngineId engine = EngineId::flite;
  std::string voice;
  std::string text;
  Speaking speaking;
  Emotion emotion = Emotion::neutral;
  double intensity = 1.0;
  double pad_before_s = 0.3;  ///< silence added around the engine's own
  double pad_after_s = 0.3;
};

/// Speaks one sentence: phones with visemes, lip closures, prominence and accents. Errors: those of the
/// engine; Errc::failed when the engine is absent or uses an unknown phone label.
Result<Clip> speak(const ClipRequest& request);

/// One after the other. Every part lasts a whole number of samples, so nothing drifts.
Clip join_clips(std::vector<Clip> parts);

/// A clip in which nobody speaks: one long pause.
Clip without_speech(std::vector<float> samples);

}  // namespace mien
