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
inline constexpr double kCommitment = 0.25;  ///< share of the quantiser's loss that moves the encoder

struct Losses {
  torch::Tensor latent, expression, jaw, total;
};

/// Adds the mean absolute errors of expression and jaw to a loss of the latent.
Losses motion_losses(const torch::Tensor& latent_loss, const torch::Tensor& predicted,
                     const torch::Tensor& truth, const LossWeights& weights);

/// The latent on its way from an encoder to the decoder.
struct Quantised {
  std::vector<std::int64_t> codes;
  torch::Tensor q;    ///< the codes, [1, N, D]; its gradient is the codebook's
  torch::Tensor z_q;  ///< their values with the gradient of z
};
Quantised quantise(const mien::probtalk3d::Quantiser<torch::Tensor>& quantiser, const torch::Tensor& z);
/// kCommitment mean((q - z)^2), which moves z, plus mean((q - z)^2), which moves the codebook.
torch::Tensor quantiser_loss(const torch::Tensor& z, const torch::Tensor& q);
/// Mean over elements of the divergence of N(mean, exp(logvar)) from N(0, 1).
torch::Tensor gaussian_divergence(const torch::Tensor& mean, const torch::Tensor& logvar);

}  // namespace mien::train::probtalk3d
