#include "synthetic_utterance.h"

#include <algorithm>
#include <array>
#include <sstream>
#include <string>

#include "mien/base/random.h"

namespace mien {
namespace {

constexpr std::array kLexicon = {
    "b ih g",    "m ae p",       "b ow t",        "m ah dh er", "w ao r m",       "f ay v",      "w uh l v z",
    "s iy",      "sh ay n iy",   "ch iy p",       "jh ah jh",   "ao r ax n jh",   "dh ax",       "ax",
    "k uh k",    "m uw n",       "b l uw",        "aw er",      "n oy z iy",      "hh ao r s",   "k w iy n",
    "l ey z iy", "y eh l ow",    "p er p ax l",   "p aa p t",   "s t eh p",       "f ih sh",     "l iy v",
    "g r iy n",  "th ih n",      "k ae t",        "f aa dh er", "k aa r",         "th ao t",     "ow n l iy",
    "s ah m",    "b er d z",     "w eh r",        "eh v r iy",  "m eh zh er",     "b ih f ao r", "s p uw n",
    "p l iy z",  "w ih dh aw t", "m y uw z ih k", "t uh k",     "aa b v iy ax s", "g uh d b ay"};

// Typical duration of a phone in connected speech, in seconds.
double typical_duration(const Visemes& v) {
  if (v.second) return 0.15;
  switch (v.first) {
    case Viseme::AX:
      return 0.05;
    case Viseme::DD:
    case Viseme::LL:
    case Viseme::RR:
    case Viseme::HH:
    case Viseme::TH:
      return 0.055;
    case Viseme::SS:
    case Viseme::CH:
    case Viseme::FF:
      return 0.10;
    default:
      return is_vowel(v.first) ? 0.11 : 0.07;
  }
}

class Speech {
 public:
  explicit Speech(std::uint64_t seed) : rng_(seed) {}

  Utterance make(double seconds) {
    pause(rng_.uniform(0.15, 0.5));
    while (now_ < seconds - 0.5) {
      const auto num_words = 3 + rng_.below(5);
      for (std::uint64_t w = 0; w < num_words && now_ < seconds - 0.5; ++w)
        rng_.chance(0.8) ? say(kLexicon[rng_.below(kLexicon.size())]) : say(nonsense());
      pause(rng_.uniform(0.1, 0.5));
    }
    pause(rng_.uniform(0.15, 0.4));
    utterance_.seconds = now_;
    utterance_.is_question = rng_.chance(0.2);
    return std::move(utterance_);
  }

 private:
  void pause(double d) {
    utterance_.phones.push_back({.start_s = now_, .end_s = now_ + d, .label = "pau", .visemes = {}});
    now_ += d;
  }

  std::string nonsense() {
    static constexpr std::array onsets = {"b", "p",  "m",  "f", "v",   "w",  "t",
                                          "s", "sh", "ch", "y", "p l", "s m"};
    static constexpr std::array nuclei = {"aa", "eh", "iy", "ow", "uw", "ay", "aw", "oy", "er", "ae"};
    std::string word;
    for (std::uint64_t syllables = 1 + rng_.below(3); syllables > 0; --syllables)
      word += std::string(onsets[rng_.below(onsets.size())]) + " " + nuclei[rng_.below(nuclei.size())] + " ";
    return word;
  }

  void say(const std::string& word) {
    const bool is_accented = rng_.chance(0.35);
    bool was_accented = false;
    std::istringstream labels(word);
    for (std::string label; labels >> label;) {
      PhoneSegment phone{.start_s = now_, .label = label, .visemes = visemes_of_arpabet(label).value()};
      phone.end_s = now_ + std::max(0.03, typical_duration(phone.visemes) * rng_.log_normal(0, 0.25));
      if (phone.is_bilabial()) phone.closure = default_closure(phone);
      if (is_vowel(phone.visemes.first)) {
        phone.prominence = std::clamp(rng_.normal(1, 0.1), 0.75, 1.25);
        if (is_accented && !was_accented) utterance_.accents_s.push_back((phone.start_s + phone.end_s) / 2);
        was_accented = true;
      }
      now_ = phone.end_s;
      utterance_.phones.push_back(phone);
    }
  }

  Rng rng_;
  Utterance utterance_;
  double now_ = 0;
};

}  // namespace

Utterance synthetic_utterance(double seconds, std::uint64_t seed) { return Speech(seed).make(seconds); }

}  // namespace mien
