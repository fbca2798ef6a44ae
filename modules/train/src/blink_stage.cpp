#include <cmath>

#include "chunk_sequence.h"
#include "condition_batch.h"
#include "mien/base/hash.h"
#include "mien/models/default/blink_history.h"

namespace mien::train {

namespace dm = default_model;

BlinkStage::BlinkStage(const TrainingSet& set, const ChunkFeatures& features, Network& network,
                       const DefaultTrainingOptions& options)
    : set_(set),
      features_(features),
      network_(network),
      options_(options),
      entries_(entries_of_at_least(set, options.sequence_chunks)) {}

std::vector<Collect::Entry> BlinkStage::parameters() {
  Collect collect;
  collect.scope("blink", network_.blink);
  return collect.entries;
}

torch::Tensor BlinkStage::loss(std::int64_t step) {
  const std::int64_t num_batch = options_.sequence_batch, num_chunks = options_.sequence_chunks;
  const std::uint64_t seed = hash_combine(hash64("blink", options_.seed), static_cast<std::uint64_t>(step));
  std::vector<torch::Tensor> speech;
  std::vector<float> history;
  std::vector<std::int64_t> classes;
  ConditionBatch condition(set_, options_.unknown_probability);
  for (std::int64_t b = 0; b < num_batch; ++b) {
    Rng rng(hash_combine(seed, static_cast<std::uint64_t>(b)));
    const auto sequence = draw_sequence(set_, entries_, num_chunks, rng);
    speech.push_back(speech_of(features_, sequence));
    condition.add(sequence.take, sequence.entry, rng);
    dm::BlinkHistory past;
    for (std::int64_t c = 0; c < sequence.first_chunk + num_chunks; ++c) {
      const std::int64_t first = set_.entries()[sequence.entry].frame_start + c * dm::kChunkFrames;
      int onset = 0;
      for (std::int64_t f = 0; f < dm::kChunkFrames && onset == 0; ++f)
        if (set_.blink_onset(sequence.take, first + f)) onset = static_cast<int>(f) + 1;
      if (c >= sequence.first_chunk) {
        const auto numbers = past.numbers();
        history.insert(history.end(), numbers.begin(), numbers.end());
        classes.push_back(onset);
      }
      past.add(onset);
    }
  }
  const auto device = options_.device;
  auto state = torch::zeros({num_batch, 1, network_.sizes.blink_hidden}, device);
  const auto c = network_.blink.condition(condition.tensors(device));
  const auto history_tensor =
      torch::from_blob(history.data(), {num_batch, num_chunks, dm::kNumBlinkClasses + 1}).clone().to(device);
  const auto logits = network_.blink(torch::stack(speech).to(device), history_tensor, c, state);
  const auto truth =
      torch::from_blob(classes.data(), {num_batch * num_chunks}, torch::kLong).clone().to(device);
  return torch::nn::functional::cross_entropy(logits.flatten(0, 1), truth);
}

}  // namespace mien::train
