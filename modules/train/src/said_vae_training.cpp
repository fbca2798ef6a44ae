#include "mien/train/said_vae_training.h"

#include <algorithm>

#include "batch_tensors.h"
#include "mien/base/contract.h"
#include "mien/base/hash.h"

namespace mien::train {

using torch::Tensor;

std::vector<double> cyclical_weights(std::int64_t num_epochs, std::int64_t num_cycles, double rising,
                                     double highest) {
  contract(num_epochs >= 1 && num_cycles >= 1,
           "cyclical_weights: at least one epoch and one cycle are needed");
  std::vector<double> weights(static_cast<std::size_t>(num_epochs), highest);
  const double period = static_cast<double>(num_epochs) / static_cast<double>(num_cycles);
  const double rise = highest / (period * rising);
  for (std::int64_t cycle = 0; cycle < num_cycles; ++cycle) {
    double value = 0;
    for (std::int64_t i = 0; value <= highest; ++i, value += rise) {
      const auto epoch =
          static_cast<std::int64_t>(static_cast<double>(i) + static_cast<double>(cycle) * period);
      if (epoch >= num_epochs) break;
      weights[static_cast<std::size_t>(epoch)] = value;
      if (!(rise > 0)) break;  // a highest weight of 0 never gets beyond it
    }
  }
  return weights;
}

Tensor BatchStatistics::operator()(const BatchNorm<Tensor>& norm, const Tensor& x) const {
  return torch::batch_norm(x.transpose(-1, -2), norm.gamma, norm.beta, norm.mean, norm.variance,
                           /*training=*/true, momentum, norm.eps, /*cudnn_enabled=*/true)
      .transpose(-1, -2);
}

void initialise_as_pytorch(said::Vae<Tensor>& vae, std::uint64_t seed) {
  Initialise start(seed);
  vae.visit(start);
  const auto entries = parameters(vae);
  draw_as_pytorch(entries, seed);
  for (const auto& e : entries)
    if (e.name.ends_with(".running_var")) e.slot->fill_(1);
}

VaeStage::VaeStage(said::Vae<Tensor>& vae, std::vector<CoefficientSequence> sequences,
                   std::vector<std::size_t> mirror, const VaeTrainingOptions& options)
    : vae_(vae),
      sequences_(std::move(sequences)),
      mirror_(std::move(mirror)),
      options_(options),
      batches_{static_cast<std::int64_t>(sequences_.size()), options.batch},
      weights_(
          cyclical_weights(options.num_epochs, options.num_cycles, options.rising, options.highest_weight)) {
  const auto width = static_cast<std::size_t>(vae.encoder.sizes.channels);
  contract(!sequences_.empty() && mirror_.size() == width,
           "VaeStage: sequences of the network's width are needed");
  for (const auto& s : sequences_)
    contract(!s.coefficients.empty() && s.coefficients.size() % width == 0,
             "VaeStage: a sequence has no whole frames");
  if (!options_.deviation.empty()) {
    contract(options_.deviation.size() == width, "VaeStage: deviations of another width");
    deviation_ = torch::tensor(options_.deviation).to(options_.device);
  }
}

Tensor VaeStage::draw_windows(Rng& random, std::int64_t count) const {
  const said::VaeSizes& sizes = vae_.encoder.sizes;
  std::vector<float> all;
  for (std::int64_t i = 0; i < count; ++i) {
    const CoefficientSequence& s = sequences_[random.below(sequences_.size())];
    const std::int64_t first = draw_window_start(random, s.num_frames(sizes.channels), sizes.window);
    std::vector<float> window = replicated_window(s.coefficients, sizes.channels, first, sizes.window);
    if (random.chance(options_.mirror_probability)) mirror_coefficients(window, mirror_);
    all.insert(all.end(), window.begin(), window.end());
  }
  return as_tensor(all, {count, sizes.window, sizes.channels}).to(options_.device);
}

Tensor VaeStage::loss(std::int64_t step) {
  const std::int64_t epoch = step / batches_.count();
  // Norms over the batch need two windows; PyTorch refuses a last batch of one.
  const std::int64_t count = std::max<std::int64_t>(2, batches_.size(step));
  const std::uint64_t seed =
      hash_combine(hash64("said_vae", options_.seed), static_cast<std::uint64_t>(step));
  Rng random(seed);
  const Tensor windows = draw_windows(random, count);
  const Tensor noise = noise_tensor(seed, {count, 1, vae_.encoder.sizes.latent}).to(options_.device);
  const VaeLoss made = vae_loss(vae_, windows, noise, deviation_, BatchStatistics{});
  const double beta = weights_[static_cast<std::size_t>(std::min(epoch, options_.num_epochs - 1))];
  return made.reconstruction + options_.velocity_weight * made.velocity + beta * made.divergence;
}

double VaeStage::reconstruction_error(const std::vector<CoefficientSequence>& sequences) const {
  const torch::NoGradGuard no_grad;
  const said::VaeSizes& sizes = vae_.encoder.sizes;
  double sum = 0;
  std::int64_t count = 0;
  for (const auto& s : sequences) {
    const std::int64_t num_windows = s.num_frames(sizes.channels) / sizes.window;
    if (num_windows == 0) continue;
    const Tensor windows =
        as_tensor(s.coefficients, {num_windows, sizes.window, sizes.channels}).to(options_.device);
    const Tensor zero = torch::zeros({num_windows, 1, sizes.latent}, windows.options());
    const VaeLoss made = vae_loss(vae_, windows, zero, deviation_, MeasuredStatistics<Tensor>{});
    sum += made.reconstruction.item<double>() * static_cast<double>(num_windows);
    count += num_windows;
  }
  return count == 0 ? 0 : sum / static_cast<double>(count);
}

}  // namespace mien::train
