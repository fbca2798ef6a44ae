#include "mien/models/probtalk3d/takes.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mien/base/contract.h"
#include "mien/base/random.h"
#include "mien/models/probtalk3d/codes.h"

namespace mien::probtalk3d {
namespace {

// 1, 2 and 3 are the default model's, FaceDiffuser's and SAiD's.
constexpr std::uint32_t kCodeStream = 4, kLatentStream = 5;

}  // namespace

Takes::Takes(const Network<Tensor>& network, Tensor z, const DrawOptions& options)
    : network_(network), options_(options), z_(std::move(z)) {
  contract(options.temperature >= 0 && options.place >= 1 && options.noise_factor >= 0,
           "Takes: the options of the draw are out of range");
  const MotionPrior<Tensor>& prior = network_.prior;
  if (prior.sizes.is_variational()) {
    mean_ = prior.mean(z_);
    logvar_ = prior.logvar(z_);
    return;
  }
  contract(prior.quantiser.fits(z_.num_rows()), "Takes: the latent of the clip is not whole codes");
  const Tensor distances = prior.quantiser.distances(z_);
  if (options.temperature == 0)
    nearest_ = nearest_codes(distances.values(), prior.quantiser.num_codes);
  else
    probabilities_ = code_probabilities(distances.values(), prior.quantiser.num_codes, options.temperature);
}

std::vector<std::int64_t> Takes::codes(std::uint64_t seed) const {
  if (network_.prior.sizes.is_variational() || options_.temperature == 0) return nearest_;
  const NoiseField noise(seed, kCodeStream);
  const CodeRace race = [&](std::int64_t chunk, std::span<float> out) {
    for (std::size_t j = 0; j < out.size(); ++j) {
      const auto index = static_cast<std::uint64_t>(chunk) * out.size() + j;
      out[j] = std::max(static_cast<float>(-std::log1p(-noise.uniform(index, 0))),
                        std::numeric_limits<float>::min());
    }
  };
  return draw_codes(probabilities_, network_.prior.quantiser.num_codes, options_.place, race);
}

Tensor Takes::take(std::uint64_t seed) const {
  const MotionPrior<Tensor>& prior = network_.prior;
  if (!prior.sizes.is_variational()) return prior.decoder(prior.quantiser.quantised(z_, codes(seed)));
  if (options_.noise_factor == 0) return prior.decoder(mean_);
  Tensor noise = Tensor::uninitialized(mean_.shape());
  NoiseField(seed, kLatentStream).normal(0, 0, noise.values());
  return prior.decoder(gaussian_sample(mean_, logvar_, noise, static_cast<float>(options_.noise_factor)));
}

}  // namespace mien::probtalk3d
