#include "carousel.h"

#include <numeric>
#include <utility>

namespace mien {

Carousel::Carousel(const std::vector<std::string>& sentences, Rng& rng)
    : sentences_(&sentences), order_(sentences.size()) {
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  for (std::size_t i = order_.size(); i > 1; --i) std::swap(order_[i - 1], order_[rng.below(i)]);
}

const std::string& Carousel::next() { return (*sentences_)[order_[at_++ % order_.size()]]; }

std::vector<std::string> Carousel::take(double seconds) {
  constexpr double kLettersPerSecond = 17;  // fast speech: slower speech fills the time with less
  std::vector<std::string> texts;
  double letters = 0;
  while (letters < kLettersPerSecond * seconds && !empty()) {
    texts.push_back(next());
    letters += static_cast<double>(texts.back().size());
  }
  return texts;
}

Carousels::Carousels(const SentenceBank& bank, Rng& rng) : english(bank.english, rng) {
  for (const auto& [voice, list] : bank.babble) babble.emplace(voice, Carousel(list, rng));
}

}  // namespace mien
