#pragma once
#include <torch/torch.h>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mien/motion/diffusion_process.h"
#include "mien/train/encoder_training.h"
#include "mien/train/epoch_order.h"
#include "mien/train/face_network.h"
#include "mien/train/face_sequence.h"

namespace mien::train {

enum class MotionLoss {
  huber,    ///< delta 1: half the squared error below 1
  squared,  ///< mean squared error
};

/// The thesis' maskings of the audio condition (table 4), which the published code does not have. `full`
/// covers the whole clip in that share of the steps, `partial` that share of the frames in every step; with
/// zeros, or with N(0, 1) noise. The thesis names them and the share; this reading of the names is ours.
enum class AudioMask { none, full_zero, full_random, partial_zero, partial_random };
std::optional<AudioMask> parse_audio_mask(std::string_view name);  ///< "none", "full_zero" ...

/// How a published system learns. The defaults are those of the published programs.
struct FaceTrainingOptions {
  std::uint64_t seed = 1;
  torch::Device device = torch::kCPU;
  MotionLoss loss = MotionLoss::huber;
  BetaSchedule schedule = BetaSchedule::cosine;
  std::int64_t diffusion_steps = 500;  ///< T; FaceXHuBERT has none
  /// A transformer reads the recorded frames as what it wrote (teacher forcing), not its own. Training only:
  /// in validation, as when it runs, it reads its own.
  bool teacher_forcing = false;
  // Randomness, all absent in evaluation.
  bool encoder_dropout = true;  ///< with the probabilities of the encoder's configuration
  bool layer_drop = true;
  bool spec_augment = true;
  double decoder_dropout = 0.3;  ///< between recurrent layers, or in a transformer's
  AudioMask mask = AudioMask::none;
  double mask_share = 0.25;
  bool cache_features = true;  ///< of the encoder's frozen front: see ClipEncoder
};

/// Training of FaceXHuBERT or FaceDiffuser: one sequence a step, all of them in a new order each epoch
/// (specifications, sections 5 and 11). Everything a step draws follows from the seed and the step.
class FaceStage {
 public:
  /// @pre freeze() was called: what needs no gradient is frozen.
  FaceStage(FaceNetwork& network, FaceSequences sequences, const FaceTrainingOptions& options);

  [[nodiscard]] std::int64_t steps_per_epoch() const {
    return static_cast<std::int64_t>(sequences_.num_train);
  }
  /// Loss of the sequence that a step belongs to. Errors: of loading; Errc::incompatible when sound or motion
  /// is too short to learn from, or of another width.
  Result<torch::Tensor> loss(std::int64_t step);
  /// Mean loss of the validation sequences in evaluation mode, each at one diffusion step of its own; 0 when
  /// there are none.
  Result<double> validation_loss(std::int64_t epoch);

  /// What a diffusion model is shown; nothing for FaceXHuBERT.
  struct Noisy {
    std::int64_t step = 0;
    torch::Tensor x_t;  ///< [1, N, D]
  };
  struct Estimate {
    torch::Tensor speech;          ///< [1, N', f H] aligned features
    torch::Tensor motion, target;  ///< [1, N', D]; N' < N where the sound is shorter
  };
  /// One sequence. Without `random` in evaluation mode. Errors: as loss(), without loading.
  Result<Estimate> estimate(const FaceSequence& sequence, const Noisy& noisy, Rng* random);
  [[nodiscard]] torch::Tensor loss_of(const Estimate& estimate) const;
  /// x_t = alpha x0 + sigma noise, both [1, N, D].
  [[nodiscard]] torch::Tensor diffuse(const torch::Tensor& x0, const torch::Tensor& noise,
                                      std::int64_t step) const;

 private:
  [[nodiscard]] torch::Tensor masked(const torch::Tensor& speech, Rng& random) const;
  [[nodiscard]] torch::Tensor predict(const FaceSequence& sequence, const torch::Tensor& speech,
                                      const Noisy& noisy, const DecoderPass<torch::Tensor>& pass) const;
  [[nodiscard]] Result<Alignment> align(const FaceSequence& sequence) const;
  Result<torch::Tensor> drawn_loss(FaceSequences::Split split, std::size_t index, std::uint64_t seed);

  FaceNetwork& network_;
  FaceSequences sequences_;
  FaceTrainingOptions options_;
  DiffusionProcess process_;
  ClipEncoder encoder_;
  EpochOrder order_;
};

}  // namespace mien::train
