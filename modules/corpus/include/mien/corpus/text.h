#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

#include "mien/base/random.h"
#include "mien/corpus/viseme.h"

namespace mien {

/// 80 English sentences that together hold all sounds of English in many neighbourhoods.
std::span<const std::string_view, 80> fixed_sentences();

/// A sentence of a small grammar (more than 10^10 different ones), capitalised, with its final mark.
std::string draw_sentence(Rng& rng);

/// 3 to 6 nonsense words of 1 to 3 syllables and a full stop, to be read by voices of any language: unusual
/// neighbours for every sound.
std::string draw_babble(Rng& rng);

/// Which part of the corpus a sentence belongs to. It follows from the text alone, so no sentence is in two
/// parts.
enum class TextSplit { train, valid, test };
/// train 90 %, valid 5 %, test 5 %.
TextSplit split_of_text(std::string_view text);

/// Chooses sentences so that rare neighbourhoods of visemes are covered: greedily by the sum over viseme
/// trigrams of 1 / (1 + how often chosen so far). Counts last between calls, so that several batches
/// complement each other.
class SentenceSelector {
 public:
  /// @param to_visemes  the visemes of a text as the engine will say it
  explicit SentenceSelector(std::function<std::vector<Viseme>(const std::string&)> to_visemes);

  /// Up to `count` different texts of `candidates`, none chosen before, in order of choice. Ties go to the
  /// earlier one.
  std::vector<std::string> select(std::span<const std::string> candidates, std::size_t count);

  /// Number of different trigrams chosen so far, of 28^3.
  [[nodiscard]] std::size_t num_trigrams() const;

 private:
  std::function<std::vector<Viseme>(const std::string&)> to_visemes_;
  std::vector<std::uint32_t> counts_;  // by trigram
  std::unordered_set<std::string> chosen_;
};

}  // namespace mien
