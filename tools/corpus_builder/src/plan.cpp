#include "plan.h"

#include <algorithm>
#include <cmath>

#include "carousel.h"
#include "mien/base/hash.h"

namespace mien {
namespace {

constexpr double kShortest = 12, kLongest = 17;  // seconds; the sentence that fills an item may run to 20
constexpr double kMeanItem = 17.1;               // seconds that these targets give, measured
constexpr double kNonSpeechShare = 0.025;

struct Part {
  EngineId engine;
  bool is_babble;
  double weight;  // hours of spec section 11
};
constexpr Part kParts[] = {
    {EngineId::espeak, false, 5.0}, {EngineId::espeak, true, 2.0}, {EngineId::flite, false, 2.5}};

}  // namespace

const std::vector<std::string>& training_variants() {
  static const std::vector<std::string> list = {
      "m1",      "m2",     "m3",     "m4",      "m5",       "m6",      "m8",       "f1",     "f2",
      "f3",      "f4",     "klatt",  "klatt2",  "klatt3",   "klatt5",  "Alex",     "Alicia", "Andrea",
      "Annie",   "Denis",  "Diogo",  "Gene",    "Henrique", "Hugo",    "Jacky",    "Lee",    "Mario",
      "Michael", "Mike",   "adam",   "anika",   "antonio",  "aunty",   "benjamin", "boris",  "caleb",
      "david",   "ed",     "edward", "grandma", "grandpa",  "gustave", "iven",     "john",   "linda",
      "max",     "michel", "miguel", "norbert", "pablo",    "paul",    "pedro",    "quincy", "rob",
      "robert",  "sandro", "shelby", "travis",  "victor",   "zac"};
  return list;
}

const std::vector<std::string>& held_out_variants() {
  static const std::vector<std::string> list = {"m7", "f5", "klatt4", "Marco", "belinda", "steph"};
  return list;
}

const std::vector<std::string>& english_voices() {
  static const std::vector<std::string> list = {"gmw/en-US",  "gmw/en-US",      "gmw/en-US",
                                                "gmw/en",     "gmw/en-GB-x-rp", "gmw/en-GB-scotland",
                                                "gmw/en-029", "gmw/en-US-nyc"};
  return list;
}

Speaking draw_espeak_speaking(Rng& rng) {
  Speaking s;
  s.rate = std::clamp(rng.normal(165, 28), 90.0, 300.0) / 165;
  s.pitch_percent = std::clamp(rng.normal(0, 18), -45.0, 45.0) / 0.8;
  s.range = std::clamp(rng.normal(55, 20), 0.0, 99.0) / 55;
  return s;
}

Speaking draw_flite_speaking(Rng& rng) {
  static constexpr double kShifts[] = {0.85, 0.93, 1.0, 1.08, 1.2};
  Speaking s;
  s.rate = 1 / std::max(0.75, rng.normal(1, 0.12));
  s.pitch_percent = 100 * (kShifts[rng.below(5)] - 1);
  return s;
}

const std::string& any_of(const std::vector<std::string>& list, Rng& rng) {
  return list[rng.below(list.size())];
}

void draw_emotion(ItemPlan& item, Rng& rng, double emotional_share) {
  item.emotion = Emotion::neutral;
  item.level = 0;
  const bool is_emotional = rng.chance(emotional_share);
  const auto which = static_cast<Emotion>(1 + rng.below(kNumEmotions - 1));
  const double u = rng.uniform();
  if (!is_emotional) return;
  item.emotion = which;
  item.level = u < 0.3 ? 1 : u < 0.7 ? 2 : 3;
}

std::vector<ItemPlan> plan_training(const TrainingPlanOptions& options, std::vector<std::string>& missing) {
  missing.clear();
  available_engines(&missing);
  std::vector<Part> parts;
  for (const auto& part : kParts)
    if (find_engine(part.engine) != nullptr) parts.push_back(part);
  if (parts.empty()) return {};
  double weights = 0, all_weights = 0;
  for (const auto& part : parts) weights += part.weight;
  for (const auto& part : kParts) all_weights += part.weight;

  // An absent engine shortens the set instead of being replaced.
  const double seconds = options.hours * 3600 * weights / all_weights;
  const auto count = static_cast<std::size_t>(std::max(1.0, std::round(seconds / kMeanItem)));
  const auto bank_size = [&](double share) {
    return std::clamp<std::size_t>(static_cast<std::size_t>(share * static_cast<double>(count)), 40, 6000);
  };
  const auto train_bank = make_sentence_bank(TextSplit::train, {bank_size(4), bank_size(0.15)}, options.seed);
  const auto valid_bank =
      make_sentence_bank(TextSplit::valid, {bank_size(0.4), bank_size(0.02)}, options.seed);
  Rng rng(hash_combine(hash64("training plan"), options.seed));
  Carousels train(train_bank, rng), valid(valid_bank, rng);

  std::vector<ItemPlan> items;
  std::vector<double> due(parts.size(), 0.0);
  for (std::size_t i = 0; i < count; ++i) {
    ItemPlan item;
    item.id = "item" + std::to_string(i);
    item.split = rng.chance(options.valid_share) ? TextSplit::valid : TextSplit::train;
    auto& sentences = item.split == TextSplit::valid ? valid : train;
    item.target_seconds = rng.uniform(kShortest, kLongest);
    draw_emotion(item, rng);
    // The part that is furthest behind its share comes next.
    for (std::size_t p = 0; p < parts.size(); ++p) due[p] += parts[p].weight / weights;
    const auto p = static_cast<std::size_t>(std::max_element(due.begin(), due.end()) - due.begin());
    due[p] -= 1;
    item.engine = parts[p].engine;
    if (item.engine == EngineId::flite) {
      static const std::vector<std::string> kVoices = {"kal16", "awb", "rms"};
      item.voice = any_of(kVoices, rng);
      item.speaking = draw_flite_speaking(rng);
      item.texts = sentences.english.take(kLongest);
    } else {
      const auto& file = parts[p].is_babble ? any_of(babble_voices(), rng) : any_of(english_voices(), rng);
      item.voice = file + "+" + any_of(training_variants(), rng);
      item.speaking = draw_espeak_speaking(rng);
      item.texts = (parts[p].is_babble ? sentences.babble.at(file) : sentences.english).take(kLongest);
    }
    items.push_back(std::move(item));
  }
  const auto num_quiet = static_cast<std::size_t>(std::ceil(kNonSpeechShare * static_cast<double>(count)));
  for (std::size_t i = 0; i < num_quiet; ++i) {
    static constexpr NonSpeech kKinds[] = {NonSpeech::noise, NonSpeech::silence, NonSpeech::tones};
    ItemPlan item;
    item.id = "quiet" + std::to_string(i);
    item.non_speech = kKinds[i % 3];
    item.target_seconds = rng.uniform(kShortest, kLongest);
    draw_emotion(item, rng);
    items.push_back(std::move(item));
  }
  return items;
}

}  // namespace mien
