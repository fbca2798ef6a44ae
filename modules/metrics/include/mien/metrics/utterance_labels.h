#pragma once
#include <vector>

#include "mien/corpus/performance.h"
#include "mien/metrics/face_events.h"
#include "mien/metrics/speech_labels.h"

namespace mien {

/// The phones of a corpus utterance as labels of the human benchmark, so that synthetic speech is scored by
/// the same rules: gaps and visemes sil become "sil" from 0.3 s on and "sp" below; bilabials carry their
/// closure window (the default one where the source has none), neighbouring ones are merged into one event;
/// labiodentals are called "f"; everything has confidence 1.
SpeechLabels labels_of(const Utterance& utterance);

/// The other way: labels of a recording as an utterance, so that the generator of the corpus can perform what
/// a person said. ARPABET phones; an unknown one becomes a schwa. No accents.
Utterance utterance_of(const SpeechLabels& labels);

/// pauses_of() as intervals.
std::vector<TimeInterval> pause_intervals(const Utterance& utterance);

}  // namespace mien
