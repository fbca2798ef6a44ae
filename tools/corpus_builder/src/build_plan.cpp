#include "build_plan.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "carousel.h"
#include "mien/base/hash.h"
#include "mien/corpus/speaker.h"

namespace mien {
namespace {

struct NamedSplit {
  CorpusSplit split;
  const char* name;
};
constexpr std::array<NamedSplit, 5> kSplits = {{{CorpusSplit::train, "train"},
                                                {CorpusSplit::valid, "valid"},
                                                {CorpusSplit::test_sentence, "test-sentence"},
                                                {CorpusSplit::test_voice, "test-voice"},
                                                {CorpusSplit::test_engine, "test-engine"}}};

// A voice that a split may use, and how often relative to the others.
struct Choice {
  EngineId engine;
  std::string voice;
  bool is_babble;
  double weight;
};

std::string file_of(const std::string& voice) { return voice.substr(0, voice.find('+')); }

std::vector<Choice> choices_of(CorpusSplit split) {
  std::vector<Choice> all;
  const auto add_espeak = [&all](const std::vector<std::string>& files,
                                 const std::vector<std::string>& variants, bool is_babble, double weight) {
    const double each = weight / static_cast<double>(files.size() * variants.size());
    for (const auto& file : files)
      for (const auto& variant : variants)
        all.push_back({EngineId::espeak, file + "+" + variant, is_babble, each});
  };
  const auto add = [&all](EngineId engine, std::initializer_list<const char*> voices, double weight) {
    for (const char* voice : voices)
      all.push_back({engine, voice, false, weight / static_cast<double>(voices.size())});
  };
  switch (split) {
    case CorpusSplit::test_voice:
      add_espeak(english_voices(), held_out_variants(), false, 1);
      add(EngineId::flite, {"slt"}, 1);
      break;
    case CorpusSplit::test_engine:
      add(EngineId::festival, {"ked", "slt_hts"}, 1);
      break;
    case CorpusSplit::train:
    case CorpusSplit::valid:
    case CorpusSplit::test_sentence:
      add_espeak(english_voices(), training_variants(), false, 5);
      add_espeak(babble_voices(), training_variants(), true, 2);
      add(EngineId::flite, {"kal16", "awb", "rms"}, 2.5);
      break;
  }
  return all;
}

// "espeak" names all voices of an engine, "espeak:gmw/en-US" a voice file, "flite:slt" a voice.
bool fits(const std::string& filter, const Choice& c) {
  const std::string engine(engine_name(c.engine));
  return filter == engine || filter == engine + ":" + c.voice || filter == engine + ":" + file_of(c.voice);
}

Result<std::vector<Choice>> usable_choices(const BuildPlanOptions& options) {
  auto choices = choices_of(options.split);
  if (!options.voices.empty()) {
    for (const auto& filter : options.voices)
      if (std::none_of(choices.begin(), choices.end(), [&](const Choice& c) { return fits(filter, c); }))
        return Error{Errc::usage, "--voice " + filter,
                     "no voice of split " + split_name(options.split) + " fits it",
                     "Use engine or engine:voice, see mien-corpus list"};
    std::erase_if(choices, [&](const Choice& c) {
      return std::none_of(options.voices.begin(), options.voices.end(),
                          [&](const std::string& f) { return fits(f, c); });
    });
  }
  std::erase_if(choices, [](const Choice& c) {
    const auto* engine = find_engine(c.engine);
    if (engine == nullptr) return true;
    const auto voices = engine->voices();
    return std::find(voices.begin(), voices.end(), file_of(c.voice)) == voices.end();
  });
  if (choices.empty())
    return Error{Errc::failed, "split " + split_name(options.split), "none of its voices is installed",
                 "See mien-corpus list"};
  return choices;
}

const Choice& draw(const std::vector<Choice>& choices, Rng& rng) {
  double total = 0;
  for (const auto& c : choices) total += c.weight;
  double left = rng.uniform() * total;
  for (const auto& c : choices) {
    left -= c.weight;
    if (left < 0) return c;
  }
  return choices.back();
}

std::string language_of(const Choice& c) {
  if (c.engine != EngineId::espeak) return "en-US";
  const auto file = file_of(c.voice);
  return file.substr(file.find('/') + 1);
}

// Evenly spread, so that any number of clips has exactly its share.
bool is_emotional(int clip, double share) {
  return std::floor((clip + 1) * share) > std::floor(clip * share);
}

TextSplit text_split(CorpusSplit split) {
  if (split == CorpusSplit::train) return TextSplit::train;
  return split == CorpusSplit::valid ? TextSplit::valid : TextSplit::test;
}

}  // namespace

std::string split_name(CorpusSplit split) {
  for (const auto& s : kSplits)
    if (s.split == split) return s.name;
  return "";
}

std::optional<CorpusSplit> parse_split(const std::string& name) {
  for (const auto& s : kSplits)
    if (name == s.name) return s.split;
  return std::nullopt;
}

std::vector<std::string> split_names() {
  std::vector<std::string> names;
  for (const auto& s : kSplits) names.emplace_back(s.name);
  return names;
}

Result<std::vector<BuildItem>> plan_build(const BuildPlanOptions& options) {
  MIEN_TRY(const auto choices, usable_choices(options));
  constexpr double kSecondsPerSentence = 3;
  const double sentences = options.clips * std::max(1.0, options.clip_seconds / kSecondsPerSentence);
  const auto count = std::clamp<std::size_t>(static_cast<std::size_t>(sentences), 20, 6000);
  const bool has_babble =
      std::any_of(choices.begin(), choices.end(), [](const Choice& c) { return c.is_babble; });
  // Training mixes nonsense into its English; people judge test clips of unseen voices by sentences.
  const bool is_plain = options.split == CorpusSplit::test_voice || options.split == CorpusSplit::test_engine;
  const SentenceBankSize size{count, has_babble ? count / 10 + 4 : 0, is_plain};
  const auto bank = make_sentence_bank(text_split(options.split), size, options.seed);
  Rng rng(hash_combine(hash64(split_name(options.split)), options.seed));
  Carousels sentences_of(bank, rng);

  std::vector<BuildItem> items;
  for (int i = 0; i < options.clips; ++i) {
    const auto& choice = draw(choices, rng);
    BuildItem item;
    const std::string number = std::to_string(i);
    item.plan.id = split_name(options.split) + "-" +
                   std::string(4 - std::min<std::size_t>(4, number.size()), '0') + number;
    item.plan.engine = choice.engine;
    item.plan.voice = choice.voice;
    item.plan.speaking =
        choice.engine == EngineId::espeak ? draw_espeak_speaking(rng) : draw_flite_speaking(rng);
    item.plan.split = text_split(options.split);
    draw_emotion(item.plan, rng, is_emotional(i, options.emotional_share) ? 1.0 : 0.0);
    item.plan.target_seconds = options.clip_seconds > 0 ? options.clip_seconds : 0.01;
    auto& carousel = choice.is_babble ? sentences_of.babble.at(file_of(choice.voice)) : sentences_of.english;
    item.plan.texts =
        options.clip_seconds > 0 ? carousel.take(options.clip_seconds + 5) : std::vector{carousel.next()};
    item.language = language_of(choice);
    const bool unseen = options.split == CorpusSplit::test_voice && !options.training_styles;
    const auto first = unseen ? kNumTrainingStyles : 0,
               last = unseen ? kNumFixedSpeakers : kNumTrainingStyles;
    item.speaker = fixed_speakers()[static_cast<std::size_t>(first) +
                                    rng.below(static_cast<std::uint64_t>(last - first))]
                       .id;
    items.push_back(std::move(item));
  }
  return items;
}

}  // namespace mien
