#pragma once
#include <optional>
#include <string>
#include <vector>

#include "mien/corpus/viseme.h"

namespace mien {

/// An interval of time, e.g. that in which the two lips touch.
struct TimeSpan {
  double start_s = 0;
  double end_s = 0;
};

/// One phone of an utterance.
struct PhoneSegment {
  double start_s = 0;
  double end_s = 0;
  std::string label = {};  ///< as the engine calls it
  Visemes visemes = {};
  double prominence = 1;                 ///< gain of the jaw opening of a vowel, 0.75 ... 1.25 (section 4.4)
  std::optional<TimeSpan> closure = {};  ///< of p, b, m; default_closure() when the source has none

  [[nodiscard]] double seconds() const { return end_s - start_s; }
  [[nodiscard]] bool is_pause() const { return visemes.first == Viseme::sil; }
  [[nodiscard]] bool is_bilabial() const { return visemes.first == Viseme::PP; }
};

/// What is said, when: everything the curves depend on besides speaker, emotion and chance.
struct Utterance {
  std::vector<PhoneSegment> phones = {};  ///< in time order; time without a phone counts as a pause
  std::vector<double> accents_s = {};     ///< instants of the accented vowels
  double seconds = 0;                     ///< of the sound, padding included
  bool is_question = false;
};

/// Closure window of a bilabial segment without one: that of the statistical flite voices (section 1.4).
TimeSpan default_closure(const PhoneSegment& segment);

/// The parts of [0, seconds] without speech, in time order.
std::vector<TimeSpan> pauses_of(const Utterance& utterance);

/// Utterances one after the other: times of the second and later ones shifted by the length of those before.
/// The result is a question when the last one is.
Utterance join(std::vector<Utterance> parts);

/// The utterance in `factor` times the duration (speed augmentation of section 10 multiplies all times).
void stretch(Utterance& utterance, double factor);

}  // namespace mien
