#pragma once
#include <vector>

#include "mien/train/default_model.h"

namespace mien::train {

/// A stretch of one take, in chunks.
struct ChunkSequence {
  std::size_t entry;
  std::int64_t take, first_chunk, num_chunks;
};

/// Entries of the training split with more than `num_chunks` chunks.
std::vector<std::size_t> entries_of_at_least(const TrainingSet& set, std::int64_t num_chunks);

/// A random sequence; one in four starts where its recording starts.
ChunkSequence draw_sequence(const TrainingSet& set, const std::vector<std::size_t>& entries,
                            std::int64_t num_chunks, Rng& rng);

/// Standardised upper-face samples at 30 fps: [num_chunks + 1, 6 U]; row 0 is the chunk before the sequence,
/// which for the start of a recording is the mean path's first frame repeated.
torch::Tensor upper_chunks(const TrainingSet& set, const ChunkFeatures& features, const Network& network,
                           const ChunkSequence& sequence);

/// What the stages on frozen features see of a batch, on the device of the options.
struct SequenceBatch {
  std::vector<ChunkSequence> sequences;                    // B
  torch::Tensor speech;                                    // [B, K, 3 W]
  default_model::ConditionInput<torch::Tensor> condition;  // [B, 1, ..]
};

/// The batch that belongs to a seed: options.sequence_batch sequences of options.sequence_chunks.
SequenceBatch draw_batch(const TrainingSet& set, const ChunkFeatures& features,
                         const std::vector<std::size_t>& entries, const DefaultTrainingOptions& options,
                         std::uint64_t seed);

/// What the steps of an event path hear of sequences of chunks: speech [B, K, 3 W] -> [B, S, groups W]. The
/// first of the S = (K - 1) 12 / frames + 1 steps is the one that hears up to the first frame of the first
/// chunk.
torch::Tensor speech_of_steps(const torch::Tensor& speech, const default_model::EventKind& kind);

}  // namespace mien::train
