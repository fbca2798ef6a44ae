#include "sentence_bank.h"

#include "engine.h"
#include "mien/base/hash.h"
#include "mien/corpus/viseme.h"

namespace mien {
namespace {

constexpr std::size_t kOversampling = 20;

void append(std::vector<Viseme>& out, Visemes visemes) {
  out.push_back(visemes.first);
  if (visemes.second) out.push_back(*visemes.second);
}

// How a text looks when an espeak voice reads it; by its letters when there is no espeak.
std::vector<Viseme> visemes_of_text(const std::string& text, const std::string& voice) {
  std::vector<Viseme> out;
  if (auto* espeak = find_engine(EngineId::espeak); espeak != nullptr) {
    for (const auto& phone : espeak->phones_of(text, voice)) append(out, visemes_of_ipa(phone));
    return out;
  }
  for (const char c : text)
    if (c != ' ') append(out, visemes_of_ipa(std::string(1, c)));
  return out;
}

// Digits, dates and spelled letters, which the engines turn into words.
std::string draw_numbers(Rng& rng) {
  static constexpr const char* kMonths[] = {"January",   "February", "March",    "April",
                                            "May",       "June",     "July",     "August",
                                            "September", "October",  "November", "December"};
  switch (rng.below(4)) {
    case 0:
      return "It costs " + std::to_string(rng.below(900) + 3) + " pounds and " +
             std::to_string(rng.below(98) + 2) + " pence.";
    case 1:
      return "They met on " + std::string(kMonths[rng.below(12)]) + " " + std::to_string(rng.below(27) + 2) +
             ", " + std::to_string(1900 + rng.below(130)) + ".";
    case 2: {
      std::string text = "The code is";
      for (int i = 0; i < 5; ++i)
        text += std::string(" ") + static_cast<char>('A' + rng.below(26)) + (i < 4 ? "," : ".");
      return text;
    }
    default: {
      std::string text = "Call";
      for (int i = 0; i < 6; ++i) text += " " + std::to_string(rng.below(10));
      return text + ".";
    }
  }
}

std::vector<std::string> candidates(TextSplit split, std::size_t count, std::string (*make)(Rng&), Rng& rng) {
  std::vector<std::string> texts;
  // A split of 5 % needs 20 texts for one candidate; a generator that repeats itself ends by the bound.
  const std::size_t wanted = count * kOversampling, bound = wanted * (split == TextSplit::train ? 2 : 40);
  for (std::size_t tries = 0; tries < bound && texts.size() < wanted; ++tries)
    if (auto text = make(rng); split_of_text(text) == split) texts.push_back(std::move(text));
  return texts;
}

}  // namespace

const std::vector<std::string>& babble_voices() {
  static const std::vector<std::string> voices = {"gmw/de",    "roa/es", "roa/it", "roa/fr", "zlw/pl",
                                                  "roa/pt-BR", "gmw/nl", "trk/tr", "bnt/sw", "poz/id",
                                                  "urj/fi",    "gmq/sv", "zlw/cs"};
  return voices;
}

SentenceBank make_sentence_bank(TextSplit split, const SentenceBankSize& size, std::uint64_t seed) {
  SentenceBank bank;
  Rng rng(hash_combine(hash64("sentence bank"), seed));
  SentenceSelector english([](const std::string& text) { return visemes_of_text(text, "gmw/en-US"); });
  const auto add = [&](std::vector<std::string>& to, SentenceSelector& selector, std::size_t count,
                       auto make) {
    const auto more = selector.select(candidates(split, count, make, rng), count);
    to.insert(to.end(), more.begin(), more.end());
  };
  std::vector<std::string> written;
  for (const auto text : fixed_sentences())
    if (split_of_text(text) == split) written.emplace_back(text);
  bank.english = english.select(written, written.size());
  const std::size_t nonsense = size.plain_english ? 0 : size.english / 4;
  const std::size_t numbers = size.plain_english ? 0 : size.english / 20;
  add(bank.english, english, size.english - nonsense - numbers, draw_sentence);
  add(bank.english, english, nonsense, draw_babble);
  add(bank.english, english, numbers, draw_numbers);
  for (const auto& voice : babble_voices()) {
    SentenceSelector selector([&voice](const std::string& text) { return visemes_of_text(text, voice); });
    add(bank.babble[voice], selector, size.babble_per_language, draw_babble);
  }
  return bank;
}

}  // namespace mien
