#include "mien/train/probtalk3d_losses.h"

#include "mien/base/contract.h"
#include "mien/core/arkit.h"
#include "mien/models/probtalk3d/codes.h"
#include "mien/models/probtalk3d/conventions.h"

namespace mien::train::probtalk3d {

using torch::Tensor;

JawChannels flame_jaw(std::int64_t num_channels) {
  using mien::probtalk3d::kNumJaw;
  return {num_channels - kNumJaw, kNumJaw};
}

JawChannels arkit_jaw() {
  constexpr std::int64_t kCount = 4;  // jawForward, jawLeft, jawRight, jawOpen, one after the other
  return {static_cast<std::int64_t>(arkit_index("jawForward")), kCount};
}

Losses motion_losses(const Tensor& latent_loss, const Tensor& predicted, const Tensor& truth,
                     const LossWeights& weights, const JawChannels& jaw) {
  contract(jaw.count > 0 && jaw.first > 0 && jaw.first + jaw.count <= truth.size(-1),
           "motion_losses: the jaw is not among the channels");
  const Tensor error = (predicted - truth).abs();
  const std::int64_t behind = jaw.first + jaw.count;
  const Tensor others =
      torch::cat({error.narrow(-1, 0, jaw.first), error.narrow(-1, behind, error.size(-1) - behind)}, -1);
  Losses losses{latent_loss, others.mean(), error.narrow(-1, jaw.first, jaw.count).mean(), {}};
  losses.total =
      weights.latent * losses.latent + weights.expression * losses.expression + weights.jaw * losses.jaw;
  return losses;
}

Quantised quantise(const mien::probtalk3d::Quantiser<Tensor>& quantiser, const Tensor& z) {
  using B = Operations<Tensor>;
  Quantised result;
  result.codes =
      mien::probtalk3d::nearest_codes(B::values(quantiser.distances(z.detach())), quantiser.num_codes);
  result.q = quantiser.latent(result.codes, B::num_rows(z));
  result.z_q = ChannelOperations<Tensor>::straight_through(z, result.q);
  return result;
}

Tensor quantiser_loss(const Tensor& z, const Tensor& q, double commitment) {
  return commitment * (q.detach() - z).square().mean() + (q - z.detach()).square().mean();
}

Tensor gaussian_divergence(const Tensor& mean, const Tensor& logvar) {
  return (0.5 * (logvar.exp() + mean.square() - 1 - logvar)).mean();
}

Latent latent_of(const Prior& prior, const Tensor& z, const Tensor& noise) {
  Latent latent;
  if (prior.sizes.is_variational()) {
    latent.mean = prior.mean(z);
    latent.logvar = prior.logvar(z);
    latent.values = mien::probtalk3d::gaussian_sample(latent.mean, latent.logvar, noise);
  } else {
    latent.codes = quantise(prior.quantiser, z);
    latent.values = latent.codes.z_q;
  }
  return latent;
}

Tensor latent_loss(const Tensor& z, const Latent& latent, double commitment) {
  return latent.mean.defined() ? gaussian_divergence(latent.mean, latent.logvar)
                               : quantiser_loss(z, latent.codes.q, commitment);
}

PriorPass pass_prior(const Prior& prior, const Tensor& motion, const Tensor& noise,
                     const PriorOptions& options) {
  const PositionDropout hooks{options.dropout};
  PriorPass pass;
  pass.z = prior.encoder(motion, hooks);
  pass.latent = latent_of(prior, pass.z, noise);
  pass.motion = prior.decoder(pass.latent.values, hooks);
  pass.losses = motion_losses(latent_loss(pass.z, pass.latent, options.commitment), pass.motion, motion,
                              options.weights, options.jaw);
  return pass;
}

}  // namespace mien::train::probtalk3d
