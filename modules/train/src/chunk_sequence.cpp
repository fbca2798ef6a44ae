#include "chunk_sequence.h"

#include <array>

#include "condition_batch.h"
#include "mien/base/hash.h"

namespace mien::train {

namespace dm = default_model;

std::vector<std::size_t> entries_of_at_least(const TrainingSet& set, std::int64_t num_chunks) {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < set.entries().size(); ++i)
    if (!set.entries()[i].is_valid && set.entries()[i].num_frames / dm::kChunkFrames > num_chunks)
      out.push_back(i);
  contract(!out.empty(), "the training set has no entry as long as a sequence");
  return out;
}

ChunkSequence draw_sequence(const TrainingSet& set, const std::vector<std::size_t>& entries,
                            std::int64_t num_chunks, Rng& rng) {
  const std::size_t entry = entries[rng.below(entries.size())];
  const auto take = static_cast<std::int64_t>(rng.below(static_cast<std::uint64_t>(set.num_takes())));
  const std::int64_t available = set.entries()[entry].num_frames / dm::kChunkFrames;
  const bool at_start = rng.chance(0.25);
  const auto first =
      at_start ? 0
               : 1 + static_cast<std::int64_t>(rng.below(static_cast<std::uint64_t>(available - num_chunks)));
  return {entry, take, first, num_chunks};
}

torch::Tensor upper_chunks(const TrainingSet& set, const ChunkFeatures& features, const Network& network,
                           const ChunkSequence& s) {
  constexpr std::int64_t kStep = dm::kChunkFrames / dm::kChunkSamples;
  const auto& entry = set.entries()[s.entry];
  const float* mean = network.statistics.face_mean.data_ptr<float>();
  const float* sd = network.statistics.face_sd.data_ptr<float>();
  torch::Tensor out = torch::empty({s.num_chunks + 1, dm::kChunkSamples * kNumUpper});
  float* to = out.data_ptr<float>();
  std::array<float, kNumFace> face;
  for (std::int64_t c = s.first_chunk - 1; c < s.first_chunk + s.num_chunks; ++c)
    for (std::int64_t i = 0; i < dm::kChunkSamples; ++i, to += kNumUpper) {
      if (c < 0) {
        const float* first = features.first_mean.data_ptr<float>() +
                             (static_cast<std::int64_t>(s.entry) * set.num_takes() + s.take) * kNumFace +
                             kNumLower;
        std::copy(first, first + kNumUpper, to);
        continue;
      }
      set.face(s.take, entry.frame_start + c * dm::kChunkFrames + i * kStep, face);
      for (std::int64_t u = 0; u < kNumUpper; ++u) {
        const std::int64_t at = kNumLower + u;
        to[u] = (face[static_cast<std::size_t>(at)] - mean[at]) / sd[at];
      }
    }
  return out;
}

SequenceBatch draw_batch(const TrainingSet& set, const ChunkFeatures& features,
                         const std::vector<std::size_t>& entries, const DefaultTrainingOptions& options,
                         std::uint64_t seed) {
  SequenceBatch batch;
  std::vector<torch::Tensor> speech;
  ConditionBatch condition(set, options.unknown_probability);
  for (std::int64_t b = 0; b < options.sequence_batch; ++b) {
    Rng rng(hash_combine(seed, static_cast<std::uint64_t>(b)));
    const auto s = draw_sequence(set, entries, options.sequence_chunks, rng);
    batch.sequences.push_back(s);
    speech.push_back(features.speech.narrow(0, features.chunk_start[s.entry] + s.first_chunk, s.num_chunks));
    condition.add(s.take, s.entry, rng);
  }
  batch.speech = torch::stack(speech).to(torch::kFloat).to(options.device);
  batch.condition = condition.tensors(options.device);
  return batch;
}

torch::Tensor speech_of_steps(const torch::Tensor& speech, const dm::EventKind& kind) {
  // Chunk c holds the groups that end at frames 12 c - 8, 12 c - 4 and 12 c. All groups in a row are
  // therefore those of steps of four frames, and a chunk's last group is the one of the step that hears up to
  // its first frame; a step of twelve frames hears a whole chunk's groups.
  const std::int64_t num_chunks = speech.size(1), per_chunk = dm::kChunkFrames / kind.frames;
  const auto steps = speech.reshape({speech.size(0), num_chunks * per_chunk, speech.size(2) / per_chunk});
  return steps.narrow(1, per_chunk - 1, (num_chunks - 1) * per_chunk + 1);
}

}  // namespace mien::train
