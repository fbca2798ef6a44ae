#pragma once
#include <torch/torch.h>

#include <cstdint>
#include <filesystem>
#include <functional>

#include "mien/models/default/network.h"
#include "mien/train/optimiser.h"
#include "mien/train/torch_operations.h"
#include "mien/train/training_set.h"

namespace mien::train {

using Network = default_model::Network<torch::Tensor>;

/// Settings of the default model's training that are not those of a stage (docs/default_model.md).
struct DefaultTrainingOptions {
  std::uint64_t seed = 1;
  torch::Device device = torch::kCPU;
  std::int64_t look_ahead_mel_frames = 14;  ///< shift of the encoder's input, 10 ms each
  double unknown_probability = 0.1;         ///< of hiding style, and independently emotion
  // Mean path.
  std::int64_t crop_frames = 150;  ///< 60 fps, a multiple of 3
  std::int64_t mean_batch = 16;
  double level_offset_sd_db = 4;  ///< of the input level, so that the normaliser need not be exact
  double difference_weight = 2, aperture_weight = 2, upper_weight = 0.2, viseme_weight = 0.1,
         event_weight = 0.1;
  // Diffusion, blink and brow paths.
  std::int64_t sequence_chunks = 56;  ///< of 200 ms
  std::int64_t sequence_batch = 24;
  std::int64_t times_per_chunk = 3;
  double history_noise = 0.15, max_snr_weight = 3;
};

/// Means and standard deviations of the 45 face numbers over the training entries (sd at least 0.01).
void measure_face_statistics(const TrainingSet& set, Network& network);

/// Stage 1: speech encoder and mean path, by squared error on single takes.
class MeanStage {
 public:
  MeanStage(const TrainingSet& set, Network& network, const DefaultTrainingOptions& options);
  [[nodiscard]] std::vector<Collect::Entry> parameters();
  /// Loss of the batch that belongs to a step.
  torch::Tensor loss(std::int64_t step);
  /// Mean loss over fixed crops of the validation entries, without augmentation.
  double validation_loss(std::int64_t num_batches);

 private:
  struct Batch;
  Batch draw(std::uint64_t seed, bool valid, bool augment) const;
  torch::Tensor loss_of(const Batch& batch) const;
  const TrainingSet& set_;
  Network& network_;
  DefaultTrainingOptions options_;
  std::vector<std::size_t> train_entries_, valid_entries_;
  torch::Tensor weights_;  // [45]
};

/// What stages 2 to 4 see of an entry, computed once with the frozen encoder: per chunk the speech context,
/// and the mean path's first frame for the history of a first chunk. Kept as half floats in one file.
Status write_chunk_features(const TrainingSet& set, Network& network, const DefaultTrainingOptions& options,
                            const std::filesystem::path& path, Progress& progress);

/// Chunk features of all entries in memory.
struct ChunkFeatures {
  static Result<ChunkFeatures> open(const std::filesystem::path& path);
  torch::Tensor speech;                   // [K, 3 W] half
  torch::Tensor first_mean;               // [takes, n, 45] standardised mean of frame 0
  std::vector<std::int64_t> chunk_start;  // [n + 1]
};

/// Standard deviation of the chunk coefficients, which the diffusion path's numbers are divided by (at least
/// 0.05).
void measure_coefficient_sd(const TrainingSet& set, const ChunkFeatures& features, Network& network,
                            const DefaultTrainingOptions& options);

/// Stage 2: diffusion of upper face, gaze and head on frozen features.
class DiffusionStage {
 public:
  DiffusionStage(const TrainingSet& set, const ChunkFeatures& features, Network& network,
                 const DefaultTrainingOptions& options);
  [[nodiscard]] std::vector<Collect::Entry> parameters();
  torch::Tensor loss(std::int64_t step);

 private:
  const TrainingSet& set_;
  const ChunkFeatures& features_;
  Network& network_;
  DefaultTrainingOptions options_;
  std::vector<std::size_t> entries_;  // long enough for a sequence
};

/// Stages 3 and 4: when blinks and raises of the brows begin, by likelihood, and how large a raise is.
class EventStage {
 public:
  enum class Events { blinks, brow_raises };
  EventStage(const TrainingSet& set, const ChunkFeatures& features, Network& network,
             const DefaultTrainingOptions& options, Events events);
  [[nodiscard]] std::vector<Collect::Entry> parameters();
  /// Negative log-likelihood of a step.
  torch::Tensor loss(std::int64_t step);

 private:
  struct Event;
  [[nodiscard]] Event event_at(std::int64_t take, const TrainingSet::Entry& entry, std::int64_t n) const;
  const TrainingSet& set_;
  const ChunkFeatures& features_;
  DefaultTrainingOptions options_;
  Events events_;
  const char* name_;
  default_model::EventPath<torch::Tensor>& path_;
  std::vector<std::size_t> entries_;
};

}  // namespace mien::train
