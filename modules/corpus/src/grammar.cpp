#include <array>
#include <cctype>

#include "mien/corpus/text.h"

namespace mien {
namespace {

constexpr std::array kDeterminers = {"the", "a", "my", "your", "his", "our", "this", "that", "every", "some"};
constexpr std::array kAdjectives = {
    "big",   "small",  "purple",  "warm",   "broken",  "shiny",  "brave",   "lazy",   "quiet",
    "awful", "clever", "golden",  "empty",  "heavy",   "yellow", "foolish", "bright", "smooth",
    "rough", "gentle", "thirsty", "royal",  "modern",  "famous", "polite",  "young",  "wild",
    "soft",  "angry",  "helpful", "simple", "massive", "fresh",  "cheap",   "odd",    "pleasant"};
constexpr std::array kNouns = {
    "baker",   "mouse",  "pilot",   "village", "fountain", "window", "river",   "teacher", "apple",
    "machine", "garden", "puppy",   "farmer",  "bridge",   "yacht",  "judge",   "zebra",   "album",
    "thunder", "voyage", "feather", "church",  "vessel",   "pencil", "shadow",  "bishop",  "camera",
    "dolphin", "engine", "forest",  "hammer",  "island",   "jacket", "kitchen", "lemon",   "mammoth",
    "napkin",  "oyster", "pepper",  "queen",   "rabbit",   "saddle", "tower",   "uncle",   "valley",
    "whistle", "fox",    "youth",   "zipper",  "beach",    "thumb",  "measure", "ship",    "cherub",
    "bubble",  "wolf",   "mother",  "brother", "cow",      "boy",    "bear",    "bird",    "book",
    "moon",    "house",  "poem",    "map"};
constexpr std::array kVerbs = {
    "follows", "watched", "painted", "believes",   "pushed", "forgave", "measured", "borrowed", "chased",
    "enjoyed", "visits",  "carried", "discovered", "hated",  "shaped",  "washes",   "moved",    "brought",
    "filmed",  "judged",  "phoned",  "paid",       "warned", "kept",    "opened",   "buried",   "squeezed",
    "joined",  "threw",   "gave",    "put",        "called", "pulled"};
constexpr std::array kPrepositions = {"under", "above",  "beside",  "behind",  "before",
                                      "near",  "beyond", "without", "through", "about"};
constexpr std::array kAdverbials = {"yesterday",
                                    "today",
                                    "at noon",
                                    "before breakfast",
                                    "this morning",
                                    "in May",
                                    "last week",
                                    "very slowly",
                                    "for five pounds",
                                    "without a word",
                                    "again and again",
                                    "once more",
                                    "for the whole family",
                                    "by the pool",
                                    "with both thumbs"};

// Of babble: syllables are onset + nucleus + sometimes a coda.
constexpr std::array kOnsets = {"b", "p",  "m",  "f",  "v",  "w",  "t",  "d",  "n",  "l",
                                "s", "z",  "k",  "g",  "r",  "sh", "ch", "j",  "th", "h",
                                "y", "bl", "pr", "st", "sp", "sm", "fl", "gr", "kw"};
constexpr std::array kNuclei = {"a", "e", "i", "o", "u", "ee", "oo", "ai", "ow", "oy", "ar", "er"};
constexpr std::array kCodas = {"p", "b", "m", "f", "v", "t", "n", "s", "k", "l", "sh"};
constexpr double kCodaProbability = 0.4;

template <class Words>
std::string_view pick(const Words& words, Rng& rng) {
  return words[rng.below(words.size())];
}

bool starts_with_vowel_letter(std::string_view word) {
  return std::string_view("aeiou").find(word.front()) != std::string_view::npos;
}

std::string noun_phrase(Rng& rng) {
  std::string_view determiner = pick(kDeterminers, rng);
  std::string rest;
  if (rng.chance(0.6)) rest = std::string(pick(kAdjectives, rng)) + " ";
  rest += pick(kNouns, rng);
  if (determiner == "a" && starts_with_vowel_letter(rest)) determiner = "an";
  return std::string(determiner) + " " + rest;
}

// Replaces N (noun phrase), V, P, T in a pattern; everything else stands for itself.
std::string fill(std::string_view pattern, Rng& rng) {
  std::string out;
  for (const char c : pattern) {
    switch (c) {
      case 'N':
        out += noun_phrase(rng);
        break;
      case 'V':
        out += pick(kVerbs, rng);
        break;
      case 'P':
        out += pick(kPrepositions, rng);
        break;
      case 'T':
        out += pick(kAdverbials, rng);
        break;
      default:
        out += c;
    }
  }
  return out;
}

}  // namespace

std::string draw_sentence(Rng& rng) {
  // Small letters stand for themselves; a sentence is capitalised afterwards.
  constexpr std::array<std::string_view, 6> kPatterns = {"N V N T.",          "N V N P N.",
                                                         "T, N V N.",         "why did N move P N?",
                                                         "N V N, but N V N.", "please give N to N T!"};
  std::string sentence = fill(kPatterns[rng.below(kPatterns.size())], rng);
  sentence.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(sentence.front())));
  return sentence;
}

std::string draw_babble(Rng& rng) {
  std::string text;
  for (std::uint64_t words = 3 + rng.below(4); words > 0; --words) {
    if (!text.empty()) text += ' ';
    for (std::uint64_t syllables = 1 + rng.below(3); syllables > 0; --syllables) {
      text += pick(kOnsets, rng);
      text += pick(kNuclei, rng);
      if (rng.chance(kCodaProbability)) text += pick(kCodas, rng);
    }
  }
  return text + ".";
}

}  // namespace mien
