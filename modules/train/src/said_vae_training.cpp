#include "mien/train/said_vae_training.h"

#include <algorithm>
#include <cmath>

#include "mien/base/contract.h"
#include "mien/base/hash.h"
#include "mien/train/coefficient_window.h"

namespace mien::train {
namespace {

using torch::Tensor;

Tensor noise_of(std::uint64_t seed, std::int64_t count, std::int64_t width) {
  Tensor noise = torch::empty({count, 1, width});
  NoiseField(seed, 1).normal(0, 0, {noise.data_ptr<float>(), static_cast<std::size_t>(noise.numel())});
  return noise;
}

Tensor as_windows(const std::vector<float>& values, std::int64_t count, const said::VaeSizes& sizes) {
  return torch::from_blob(const_cast<float*>(values.data()), {count, sizes.window, sizes.channels},
                          torch::kFloat)
      .clone();
}

}  // namespace

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
  const torch::NoGradGuard no_grad;
  double bound = 0;  // of the weight before: its bias has the same
  for (const auto& e : parameters(vae)) {
    if (e.name.ends_with(".running_var")) e.slot->fill_(1);
    const bool is_weight = e.name.ends_with(".weight");
    // Also of transposed convolutions [in, out, kernel], whose inputs PyTorch counts so.
    if (is_weight && e.slot->dim() > 1)
      bound = std::sqrt(static_cast<double>(e.slot->size(0)) / static_cast<double>(e.slot->numel()));
    if (!e.trained || (e.slot->dim() == 1 && (is_weight || bound == 0))) {
      bound = 0;  // a norm: its bias stays 0
      continue;
    }
    Rng random(hash64(e.name, mix64(seed)));
    float* p = e.slot->data_ptr<float>();
    for (std::int64_t i = 0; i < e.slot->numel(); ++i)
      p[i] = static_cast<float>(random.uniform(-bound, bound));
  }
}

VaeStage::VaeStage(said::Vae<Tensor>& vae, std::vector<CoefficientSequence> sequences,
                   std::vector<std::size_t> mirror, const VaeTrainingOptions& options)
    : vae_(vae),
      sequences_(std::move(sequences)),
      mirror_(std::move(mirror)),
      options_(options),
      weights_(
          cyclical_weights(options.num_epochs, options.num_cycles, options.rising, options.highest_weight)) {
  const auto width = static_cast<std::size_t>(vae.encoder.sizes.channels);
  contract(!sequences_.empty() && mirror_.size() == width,
           "VaeStage: sequences of the network's width are needed");
  for (const auto& s : sequences_)
    contract(!s.values.empty() && s.values.size() % width == 0, "VaeStage: a sequence has no whole frames");
  if (!options_.deviation.empty()) {
    contract(options_.deviation.size() == width, "VaeStage: deviations of another width");
    deviation_ = torch::tensor(options_.deviation).to(options_.device);
  }
}

std::int64_t VaeStage::steps_per_epoch() const {
  return (static_cast<std::int64_t>(sequences_.size()) + options_.batch - 1) / options_.batch;
}

Tensor VaeStage::draw_windows(Rng& random, std::int64_t count) const {
  const said::VaeSizes& sizes = vae_.encoder.sizes;
  std::vector<float> all;
  for (std::int64_t i = 0; i < count; ++i) {
    const auto& values = sequences_[random.below(sequences_.size())].values;
    const std::int64_t length = static_cast<std::int64_t>(values.size()) / sizes.channels,
                       half = sizes.window / 2;
    const std::int64_t last =
        std::max<std::int64_t>(0, length - half - 1);  // the window may begin at -half ... last
    const auto first =
        static_cast<std::int64_t>(random.below(static_cast<std::uint64_t>(last + half + 1))) - half;
    std::vector<float> window = replicated_window(values, sizes.channels, first, sizes.window);
    if (random.chance(options_.mirror_probability)) mirror_coefficients(window, mirror_);
    all.insert(all.end(), window.begin(), window.end());
  }
  return as_windows(all, count, sizes).to(options_.device);
}

Tensor VaeStage::loss(std::int64_t step) {
  const auto num_sequences = static_cast<std::int64_t>(sequences_.size());
  const std::int64_t epoch = step / steps_per_epoch(), place = step % steps_per_epoch();
  // Norms over the batch need two windows; PyTorch refuses a last batch of one.
  const std::int64_t count =
      std::max<std::int64_t>(2, std::min(options_.batch, num_sequences - place * options_.batch));
  const std::uint64_t seed =
      hash_combine(hash64("said_vae", options_.seed), static_cast<std::uint64_t>(step));
  Rng random(seed);
  const Tensor windows = draw_windows(random, count);
  const Tensor noise = noise_of(seed, count, vae_.encoder.sizes.latent).to(options_.device);
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
    const std::int64_t num_windows =
        static_cast<std::int64_t>(s.values.size()) / sizes.channels / sizes.window;
    if (num_windows == 0) continue;
    const Tensor windows = as_windows(s.values, num_windows, sizes).to(options_.device);
    const Tensor zero = torch::zeros({num_windows, 1, sizes.latent}, windows.options());
    const VaeLoss made = vae_loss(vae_, windows, zero, deviation_, MeasuredStatistics<Tensor>{});
    sum += made.reconstruction.item<double>() * static_cast<double>(num_windows);
    count += num_windows;
  }
  return count == 0 ? 0 : sum / static_cast<double>(count);
}

}  // namespace mien::train
