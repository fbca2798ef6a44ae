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

/// Speech context of the sequence: [num_chunks, 3 W] float.
torch::Tensor speech_of(const ChunkFeatures& features, const ChunkSequence& sequence);

}  // namespace mien::train
