#pragma once
#include <torch/torch.h>

#include <cstdint>
#include <vector>

#include "mien/train/encoder_training.h"
#include "mien/train/epoch_order.h"
#include "mien/train/face_sequence.h"
#include "mien/train/probtalk3d_losses.h"

// How both stages of ProbTalk3D and of its Gaussian variant learn (specification, sections 6.4, 6.5, 7 and
// 9): one clip a step, all of them in a new order each epoch. Everything a step draws follows from the seed
// and the step.
namespace mien::train::probtalk3d {

/// Both stages behind the speech encoder: parameters as in a model file.
struct TalkingNetwork {
  SpeechEncoder<torch::Tensor> encoder;
  mien::probtalk3d::Network<torch::Tensor> network;

  template <class V>
  void visit(V& v) {
    v.scope("audio_encoder", encoder);
    network.visit(v);
  }
};

/// Start values as PyTorch has them; codes uniform in +-1 / their number. The speech encoder's are of no use
/// where there is a trained one.
void initialise_as_published(Prior& prior, std::uint64_t seed);
void initialise_as_published(TalkingNetwork& network, std::uint64_t seed);

/// A validation in evaluation mode. Figures are means over sequences, as the published programs print them.
struct Validation {
  std::vector<double> losses;        ///< total, of each sequence in turn
  double expression = 0, jaw = 0;    ///< mean absolute errors in the range of the model
  double perplexity = 0;             ///< how many codes a clip uses; 0 in the Gaussian variant
  double mean_l2 = 0, mean_var = 0;  ///< mien::probtalk3d::motion_distance()
  [[nodiscard]] double mean_loss() const;
};

struct StageSettings {
  std::uint64_t seed = 1;
  torch::Device device = torch::kCPU;
  PriorOptions prior{.dropout = kPositionDropout};
};

/// Stage 1: motion to a latent and back.
class PriorStage {
 public:
  /// @param sequences  in the range of the model; nothing is heard
  PriorStage(Prior& prior, FaceSequences sequences, const StageSettings& settings);
  [[nodiscard]] std::int64_t steps_per_epoch() const {
    return static_cast<std::int64_t>(sequences_.num_train);
  }
  /// Errors: of loading; Errc::incompatible for a motion of fewer than 2 or of more frames than there are
  /// positions, or of another width.
  Result<torch::Tensor> loss(std::int64_t step);
  Result<Validation> validate(std::int64_t epoch);

 private:
  Result<PriorPass> pass(const FaceSequence& sequence, std::uint64_t seed, double dropout) const;

  Prior& prior_;
  FaceSequences sequences_;
  StageSettings settings_;
  EpochOrder order_;
};

struct PredictorSettings {
  std::uint64_t seed = 1;
  torch::Device device = torch::kCPU;
  LossWeights weights = kPredictor;
  JawChannels jaw{};
  double dropout = kPositionDropout;  ///< in the predictor
  /// In the frozen prior. The published program has it at work there by accident: its trainer switches all
  /// modules to training, frozen or not.
  double prior_dropout = kPositionDropout;
  EncoderNoise encoder{};
  bool keeps_features = true;  ///< of the speech encoder: see ClipEncoder
};

/// Stage 2: speech and style to the latent of a frozen prior.
class PredictorStage {
 public:
  /// @pre the prior is frozen: freeze() was called
  PredictorStage(TalkingNetwork& network, FaceSequences sequences, const PredictorSettings& settings);
  [[nodiscard]] std::int64_t steps_per_epoch() const {
    return static_cast<std::int64_t>(sequences_.num_train);
  }
  /// Errors as PriorStage::loss(); sound that is too short for 2 frames.
  Result<torch::Tensor> loss(std::int64_t step);
  Result<Validation> validate(std::int64_t epoch);

 private:
  struct Pass;
  Result<Pass> pass(const FaceSequence& sequence, std::uint64_t seed, bool is_training);

  TalkingNetwork& network_;
  FaceSequences sequences_;
  PredictorSettings settings_;
  ClipEncoder encoder_;
  EpochOrder order_;
};

}  // namespace mien::train::probtalk3d
