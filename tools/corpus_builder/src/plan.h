#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "engine.h"
#include "mien/corpus/emotion.h"
#include "sentence_bank.h"

namespace mien {

enum class NonSpeech { none, noise, silence, tones };

/// One item before it is spoken: sentences of one voice, emotion and level that are joined until
/// `target_seconds` are full. Everything random about it besides takes and augmentation is decided here.
struct ItemPlan {
  std::string id;
  EngineId engine = EngineId::flite;
  std::string voice;  ///< as Engine::synthesise takes it
  Speaking speaking;  ///< of the voice, before emotion
  Emotion emotion = Emotion::neutral;
  int level = 0;  ///< 1, 2, 3; 0 for neutral
  double target_seconds = 15;
  std::vector<std::string> texts;  ///< spoken in this order; the rest is not needed once the item is full
  NonSpeech non_speech = NonSpeech::none;
  TextSplit split = TextSplit::train;

  [[nodiscard]] double intensity() const {
    return level == 0 ? 1.0 : static_cast<double>(intensity_of_level(level));
  }
};

struct TrainingPlanOptions {
  double hours = 9.5;  ///< of distinct speech
  std::uint64_t seed = 1;
  double valid_share = 0.05;  ///< of the items: unseen sentences, seen voices
};

/// Items of a training set in the proportions of spec section 11 (E1 5 : E2 2 : F1 2.5; festival is left for
/// the tests), half of them emotional with levels 30/40/30 %, and 2.5 % without speech. Parts of absent
/// engines are left out; `missing` says which.
std::vector<ItemPlan> plan_training(const TrainingPlanOptions& options, std::vector<std::string>& missing);

/// Timbre variants of espeak for training, and those that only tests may use (spec section 11).
const std::vector<std::string>& training_variants();
const std::vector<std::string>& held_out_variants();
/// Espeak voice files for English, en-US three times as likely.
const std::vector<std::string>& english_voices();

// How a voice is varied from item to item; shared with the evaluation sets.
Speaking draw_espeak_speaking(Rng& rng);
Speaking draw_flite_speaking(Rng& rng);
/// One of the seven emotions at level 1, 2, 3 (30, 40, 30 %) with the given probability, else neutral (level
/// 0).
void draw_emotion(ItemPlan& item, Rng& rng, double emotional_share = 0.5);
/// One element, equally likely. @pre not empty
const std::string& any_of(const std::vector<std::string>& list, Rng& rng);

}  // namespace mien
