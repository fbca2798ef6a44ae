#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "mien/corpus/corpus_files.h"
#include "mien/corpus/speaker.h"
#include "mien/metrics/condition_fidelity.h"
#include "mien/metrics/synthetic_benchmark.h"

namespace mien {

// Everything known about one item before a system sees it.
struct ItemTruth {
  const CorpusItem& item;
  const Speaker& speaker;
  Utterance utterance;
  std::vector<Motion> takes;  // [M], the basis of the conditional mean
  Motion held_out;
};

// Draws the M + 1 takes of an item on `threads` threads.
ItemTruth draw_truth(const CorpusItem& item, const Speaker& speaker, Utterance utterance,
                     std::uint64_t corpus_seed, const SyntheticOptions& options);

// Every figure of one item except condition fidelity.
SyntheticItemScore score_item(const ItemTruth& truth, std::span<const Motion> samples);

// Material of the three condition classifiers. Training: true takes of every item in all emotions and levels,
// and of neutral items in all styles, so that what is said cannot stand in for the condition. Judged: takes
// of the item in its own condition.
struct ConditionMaterial {
  std::vector<ConditionExample> emotion, level, style;

  void append(const ConditionMaterial& other);
};
ConditionMaterial training_material(const ItemTruth& truth, std::uint64_t corpus_seed, int threads);
ConditionMaterial judged_material(const ItemTruth& truth, std::span<const Motion> takes);

}  // namespace mien
