#pragma once
#include <torch/torch.h>

#include "mien/models/probtalk3d/network.h"
#include "mien/train/torch_channel_operations.h"

// Losses of ProbTalk3D as its programs compute them (the paper's formulas differ: docs/probtalk3d.md). Motion
// is [1, N, C] in the normalised range; all means are over elements.
namespace mien::train::probtalk3d {

/// Weights of the terms. `latent` weighs the quantiser's loss, the KL divergence, or the distance of latents.
struct LossWeights {
  double latent, expression, jaw;
};
inline constexpr LossWeights kQuantisedPrior{1.5, 0.5, 0.1}, kGaussianPrior{1e-4, 1.5, 1.0},
    kPredictor{1.0, 0.15, 0.1};
inline constexpr double kCommitment = 0.25;      ///< share of the quantiser's loss that moves the encoder
inline constexpr double kPositionDropout = 0.1;  ///< behind the positions, the only dropout there is

/// The channels of the jaw, which have a loss of their own: FLAME's last three, or ARKit's four.
struct JawChannels {
  std::int64_t first = 0, count = 0;
};
JawChannels flame_jaw(std::int64_t num_channels);
JawChannels arkit_jaw();  ///< in the order of arkit_names()

struct Losses {
  torch::Tensor latent, expression, jaw, total;
};

/// Adds the mean absolute errors of the jaw and of all other channels to a loss of the latent.
Losses motion_losses(const torch::Tensor& latent_loss, const torch::Tensor& predicted,
                     const torch::Tensor& truth, const LossWeights& weights, const JawChannels& jaw);

/// The latent on its way from an encoder to the decoder.
struct Quantised {
  std::vector<std::int64_t> codes;
  torch::Tensor q;    ///< the codes, [1, N, D]; its gradient is the codebook's
  torch::Tensor z_q;  ///< their values with the gradient of z
};
Quantised quantise(const mien::probtalk3d::Quantiser<torch::Tensor>& quantiser, const torch::Tensor& z);
/// commitment mean((q - z)^2), which moves z, plus mean((q - z)^2), which moves the codebook.
torch::Tensor quantiser_loss(const torch::Tensor& z, const torch::Tensor& q, double commitment = kCommitment);
/// Mean over elements of the divergence of N(mean, exp(logvar)) from N(0, 1).
torch::Tensor gaussian_divergence(const torch::Tensor& mean, const torch::Tensor& logvar);

using Prior = mien::probtalk3d::MotionPrior<torch::Tensor>;

/// What the decoder of a prior is given for z of an encoder or of the predictor: codes, or a draw from
/// N(mean, exp(logvar)).
struct Latent {
  torch::Tensor values;        ///< [1, N, D]
  Quantised codes;             ///< of a prior with codes
  torch::Tensor mean, logvar;  ///< of the Gaussian variant
};
/// @param noise  [1, N, D], of the Gaussian variant; not read by the other
Latent latent_of(const Prior& prior, const torch::Tensor& z, const torch::Tensor& noise);
/// The loss of the latent itself: quantiser_loss() or gaussian_divergence().
torch::Tensor latent_loss(const torch::Tensor& z, const Latent& latent, double commitment);

/// Drops numbers behind the positions.
struct PositionDropout {
  double probability = 0;  ///< 0: evaluation
  [[nodiscard]] torch::Tensor dropout(torch::Tensor x) const {
    return probability > 0 ? torch::dropout(x, probability, /*train=*/true) : x;
  }
  void stage(const char* /*name*/, const torch::Tensor& /*x*/) const {}
};

struct PriorOptions {
  LossWeights weights = kQuantisedPrior;
  JawChannels jaw{};
  double commitment = kCommitment;
  double dropout = 0;  ///< behind the positions
};
/// A motion [1, N, C] through stage 1 and back, with every intermediate that has a gradient of its own.
struct PriorPass {
  torch::Tensor z;
  Latent latent;
  torch::Tensor motion;  ///< [1, N, C]
  Losses losses;
};
PriorPass pass_prior(const Prior& prior, const torch::Tensor& motion, const torch::Tensor& noise,
                     const PriorOptions& options);

}  // namespace mien::train::probtalk3d
