#include <algorithm>
#include <queue>

#include "mien/corpus/text.h"

namespace mien {
namespace {

using Trigrams = std::vector<std::uint16_t>;

// All runs of three visemes, with a pause at both ends.
Trigrams trigrams_of(std::vector<Viseme> visemes) {
  visemes.insert(visemes.begin(), Viseme::sil);
  visemes.push_back(Viseme::sil);
  Trigrams out;
  for (std::size_t i = 2; i < visemes.size(); ++i)
    out.push_back(static_cast<std::uint16_t>(
        (static_cast<int>(visemes[i - 2]) * kNumVisemes + static_cast<int>(visemes[i - 1])) * kNumVisemes +
        static_cast<int>(visemes[i])));
  return out;
}

double score(const Trigrams& trigrams, const std::vector<std::uint32_t>& counts) {
  double sum = 0;
  for (const std::uint16_t t : trigrams) sum += 1.0 / (1.0 + counts[t]);
  return sum;
}

struct Candidate {
  double score;  // as of some earlier moment: an upper bound, because counts only grow
  std::size_t index;
  bool operator<(const Candidate& other) const {
    return score != other.score ? score < other.score : index > other.index;
  }
};

}  // namespace

SentenceSelector::SentenceSelector(std::function<std::vector<Viseme>(const std::string&)> to_visemes)
    : to_visemes_(std::move(to_visemes)), counts_(kNumVisemes * kNumVisemes * kNumVisemes) {}

std::vector<std::string> SentenceSelector::select(std::span<const std::string> candidates,
                                                  std::size_t count) {
  std::vector<Trigrams> trigrams(candidates.size());
  std::priority_queue<Candidate> queue;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (chosen_.contains(candidates[i])) continue;
    trigrams[i] = trigrams_of(to_visemes_(candidates[i]));
    queue.push({score(trigrams[i], counts_), i});
  }
  // Lazy greedy choice: only the candidate on top is scored again. When it stays on top, nothing below can
  // beat it.
  std::vector<std::string> selected;
  while (selected.size() < count && !queue.empty()) {
    Candidate best = queue.top();
    queue.pop();
    if (chosen_.contains(candidates[best.index])) continue;
    best.score = score(trigrams[best.index], counts_);
    if (!queue.empty() && best < queue.top()) {
      queue.push(best);
      continue;
    }
    for (const std::uint16_t t : trigrams[best.index]) ++counts_[t];
    chosen_.insert(candidates[best.index]);
    selected.push_back(candidates[best.index]);
  }
  return selected;
}

std::size_t SentenceSelector::num_trigrams() const {
  return static_cast<std::size_t>(
      std::count_if(counts_.begin(), counts_.end(), [](auto n) { return n > 0; }));
}

}  // namespace mien
