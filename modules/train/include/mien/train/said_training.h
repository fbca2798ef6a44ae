#pragma once
#include <torch/torch.h>

#include <cstdint>
#include <string>
#include <vector>

#include "mien/models/said/network.h"
#include "mien/models/said/schedule.h"
#include "mien/models/speech_encoder/network.h"
#include "mien/train/coefficient_window.h"
#include "mien/train/torch_operations.h"
#include "mien/train/torch_parameters.h"

// How the denoiser of SAiD learns (specification of SAiD, section 7). Letters: B windows of a batch, W frames
// of each, K coefficients.
namespace mien::train {

/// SAiD with its speech encoder: parameters as in a model file.
struct SaidNetwork {
  SpeechEncoder<torch::Tensor> encoder;
  said::Network<torch::Tensor> head;

  template <class V>
  void visit(V& v) {
    v.scope("audio_encoder", encoder);
    head.visit(v);
  }
};

/// Start values as PyTorch has them; what the published program sets to zero is zero. The encoder's are of no
/// use: load a trained one.
void initialise_as_published(SaidNetwork& network, std::uint64_t seed);

/// What a batch costs, each a mean over all its numbers.
struct SaidLoss {
  torch::Tensor prediction;  ///< of the estimate [B, W, K] from the target
  torch::Tensor velocity;    ///< of their differences from frame to frame
  torch::Tensor vertices;    ///< of the vertices that both move; undefined without residuals
};
struct SaidLossOptions {
  bool is_squared = false;    ///< squared errors; as published absolute ones
  torch::Tensor deviation{};  ///< [K], which estimate and target are divided by; undefined: they are not
  torch::Tensor residuals{};  ///< [B, K, V, 3] of a unit of each coefficient; undefined: no vertices
};
SaidLoss said_loss(const torch::Tensor& estimate, const torch::Tensor& target,
                   const SaidLossOptions& options);

/// What a network of that kind should say of x0 [B, W, K] with that noise at those levels (one for each
/// batch).
torch::Tensor said_target(Prediction prediction, const torch::Tensor& x0, const torch::Tensor& noise,
                          const std::vector<NoiseLevel>& levels);

/// The defaults are those of the published program.
struct SaidTrainingOptions {
  std::uint64_t seed = 1;
  torch::Device device = torch::kCPU;
  std::int64_t batch = 8;
  std::int64_t shortest_window = 120;      ///< frames; the longest is the shortest sequence of the batch
  double unconditional_probability = 0.1;  ///< that a window is learnt without its sound
  double mirror_probability = 0.5;
  double shift_probability = 0.5;  ///< that the sound is up to a sample early or late
  bool is_squared = false;
  double velocity_weight = 1;
  std::vector<float> deviation{};  ///< [K]; empty: differences are not divided
  BetaSchedule schedule = BetaSchedule::cosine;
  std::int64_t diffusion_steps = 1000;
  // Also in a frozen encoder.
  bool encoder_dropout = true, layer_drop = true, spec_augment = true;
  double dropout = 0.1;  ///< in the denoiser's residual blocks
};

/// A batch that training draws, or a recorded one.
struct SaidBatch {
  torch::Tensor waveform;                 ///< [B, S, 1], normalised
  torch::Tensor coefficients;             ///< [B, W, K]
  std::vector<std::uint8_t> conditioned;  ///< [B] 1: with its sound
  std::vector<std::int64_t> steps;        ///< [B]
  torch::Tensor noise;                    ///< [B, W, K]
};

/// Sound of a window of `num_frames` frames that begins at frame `first`, or `shift` samples later: the first
/// and last sample go on outside the clip. Not normalised.
std::vector<float> said_sound_window(std::span<const float> waveform, std::int64_t first,
                                     std::int64_t num_frames, std::int64_t shift);

/// Each step takes a batch of windows at random places of random sequences, as many sequences an epoch as
/// there are; everything a step draws follows from the seed and the step.
class SaidStage {
 public:
  /// @param mirror  mirror_order() of the coefficients. @pre sequences are not empty and have whole frames
  /// and sound; the parameters that learn require gradients
  SaidStage(SaidNetwork& network, std::vector<CoefficientSequence> sequences, std::vector<std::size_t> mirror,
            const SaidTrainingOptions& options);

  [[nodiscard]] std::int64_t steps_per_epoch() const { return batches_.count(); }
  torch::Tensor loss(std::int64_t step);
  /// Mean loss over `num_passes` passes of whole sequences, one a batch, in evaluation mode; steps, noise and
  /// left-out conditions are drawn. 0 without sequences. Errors: a sequence whose sound is shorter than the
  /// encoder's first frame (incompatible).
  Result<double> validation_loss(const std::vector<CoefficientSequence>& sequences, std::int64_t num_passes,
                                 std::uint64_t seed);

  [[nodiscard]] SaidBatch draw(std::int64_t step) const;
  /// Features of the sound [B, W, speech]. Without `random` in evaluation mode.
  [[nodiscard]] torch::Tensor encode(const SaidBatch& batch, Rng* random) const;
  [[nodiscard]] torch::Tensor diffuse(const SaidBatch& batch) const;
  /// The network's estimate of the noise, from features or, where a window is not conditioned, without.
  [[nodiscard]] torch::Tensor estimate(const SaidBatch& batch, const torch::Tensor& features,
                                       bool drops) const;
  [[nodiscard]] torch::Tensor total(const SaidLoss& loss) const;
  [[nodiscard]] SaidLoss loss_of(const SaidBatch& batch, const torch::Tensor& estimate) const;

 private:
  [[nodiscard]] SaidBatch whole(const CoefficientSequence& sequence, std::uint64_t seed) const;
  void draw_diffusion(SaidBatch& batch, Rng& random, std::uint64_t seed) const;

  SaidNetwork& network_;
  std::vector<CoefficientSequence> sequences_;
  std::vector<std::size_t> mirror_;
  SaidTrainingOptions options_;
  EpochBatches batches_;
  DiffusionProcess process_;
  bool encoder_is_frozen_;
  torch::Tensor deviation_;
};

}  // namespace mien::train
