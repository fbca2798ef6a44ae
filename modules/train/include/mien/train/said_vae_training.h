#pragma once
#include <torch/torch.h>

#include <cstdint>
#include <string>
#include <vector>

#include "mien/models/said/vae.h"
#include "mien/train/coefficient_window.h"
#include "mien/train/torch_channel_operations.h"
#include "mien/train/torch_parameters.h"

// How SAiD's motion codec learns (specification of SAiD, section 8.1).
namespace mien::train {

/// The weight of the divergence by epoch, `cycles` times: it rises linearly from 0 to `highest` in the share
/// `rising` of a cycle and stays there (Fu et al. 2019). Sums as in the authors' program, so that the same
/// epochs change. @pre num_epochs, num_cycles >= 1
std::vector<double> cyclical_weights(std::int64_t num_epochs, std::int64_t num_cycles, double rising = 0.5,
                                     double highest = 1);

/// Normalises with the statistics of the batch and its rows, and moves those of the layer towards them.
struct BatchStatistics {
  double momentum = 0.1;  ///< PyTorch's default
  torch::Tensor operator()(const BatchNorm<torch::Tensor>& norm, const torch::Tensor& x) const;
};

/// All starting values as PyTorch draws them: uniform in +-1 / sqrt(inputs), biases like their weights; norms
/// do nothing.
void initialise_as_pytorch(said::Vae<torch::Tensor>& vae, std::uint64_t seed);

struct VaeLoss {
  torch::Tensor reconstruction;  ///< half the sum of squared differences to the window, mean over the batch
  torch::Tensor divergence;      ///< of the codes from N(0, 1), mean over the batch
  torch::Tensor velocity;        ///< as reconstruction, of the differences from frame to frame
};
/// What a batch of windows [B, W, K] costs.
/// @param noise      [B, 1, L], of the codes: code = mean + exp(log variance / 2) noise
/// @param deviation  [K], by which differences are divided; undefined: none
template <class Norm>
VaeLoss vae_loss(const said::Vae<torch::Tensor>& vae, const torch::Tensor& windows,
                 const torch::Tensor& noise, const torch::Tensor& deviation, const Norm& norm) {
  using torch::Tensor;
  const Tensor hidden = vae.encoder.hidden(vae.encoder.flattened(windows, norm), norm);
  const Tensor mean = vae.encoder.mean(hidden), log_variance = vae.encoder.log_variance(hidden);
  const Tensor made = vae.decoder(mean + (log_variance / 2).exp() * noise, norm);
  const Tensor off = deviation.defined() ? (windows - made) / deviation : windows - made;
  const std::int64_t last = off.size(1) - 1;
  const auto batch = static_cast<double>(windows.size(0));
  return {0.5 / batch * off.square().sum(),
          0.5 / batch * (mean.square() + log_variance.exp() - log_variance - 1).sum(),
          0.5 / batch * (off.narrow(1, 1, last) - off.narrow(1, 0, last)).square().sum()};
}

/// The defaults are those of the published program.
struct VaeTrainingOptions {
  std::uint64_t seed = 1;
  torch::Device device = torch::kCPU;
  std::int64_t num_epochs = 100'000;
  std::int64_t batch = 8;
  double mirror_probability = 0.5;
  double velocity_weight = 1;
  std::int64_t num_cycles = 10;  ///< of the divergence's weight
  double rising = 0.5, highest_weight = 1;
  std::vector<float> deviation{};  ///< [K] of the coefficients; empty: differences are not divided
};

/// Each step takes a batch of windows at random places of random sequences, as many sequences an epoch as
/// there are; everything a step draws follows from the seed and the step.
class VaeStage {
 public:
  /// @param mirror  mirror_order() of the coefficients. @pre sequences are not empty and have whole frames
  VaeStage(said::Vae<torch::Tensor>& vae, std::vector<CoefficientSequence> sequences,
           std::vector<std::size_t> mirror, const VaeTrainingOptions& options);

  [[nodiscard]] std::int64_t steps_per_epoch() const { return batches_.count(); }
  [[nodiscard]] std::int64_t num_steps() const { return options_.num_epochs * steps_per_epoch(); }
  torch::Tensor loss(std::int64_t step);
  /// Mean reconstruction error of the means of all windows of `sequences` that follow each other without
  /// overlap, with the measured statistics: what validation prints. 0 when none is as long as a window.
  [[nodiscard]] double reconstruction_error(const std::vector<CoefficientSequence>& sequences) const;

 private:
  [[nodiscard]] torch::Tensor draw_windows(Rng& random, std::int64_t count) const;

  said::Vae<torch::Tensor>& vae_;
  std::vector<CoefficientSequence> sequences_;
  std::vector<std::size_t> mirror_;
  VaeTrainingOptions options_;
  EpochBatches batches_;
  std::vector<double> weights_;  // of the divergence, by epoch
  torch::Tensor deviation_;
};

}  // namespace mien::train
