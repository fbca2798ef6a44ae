#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "mien/corpus/text.h"

namespace mien {

/// Sentences of one part of the corpus in every language that it speaks. Parts never share a sentence:
/// split_of_text().
struct SentenceBank {
  std::vector<std::string> english;                        ///< written sentences, grammar, nonsense, numbers
  std::map<std::string, std::vector<std::string>> babble;  ///< nonsense words by espeak voice file ("gmw/de")
};

struct SentenceBankSize {
  std::size_t english = 0;  ///< besides the written sentences
  std::size_t babble_per_language = 0;
  bool plain_english = false;  ///< sentences only; else 25 % of the English is nonsense, 5 % numbers
};

/// Chooses a bank from 20 times as many candidates, so that rare viseme trigrams are covered (spec section
/// 9). Espeak tells how a candidate sounds; without it its letters decide. Lists come out shorter where a
/// generator repeats itself.
SentenceBank make_sentence_bank(TextSplit split, const SentenceBankSize& size, std::uint64_t seed);

/// Espeak voice files that speak babble: de es it fr pl pt-br nl tr sw id fi sv cs.
const std::vector<std::string>& babble_voices();

}  // namespace mien
