#include "mien/train/probtalk3d_losses.h"

#include "mien/models/probtalk3d/codes.h"
#include "mien/models/probtalk3d/conventions.h"

namespace mien::train::probtalk3d {

using mien::probtalk3d::kNumJaw;
using torch::Tensor;

Losses motion_losses(const Tensor& latent_loss, const Tensor& predicted, const Tensor& truth,
                     const LossWeights& weights) {
  const Tensor error = (predicted - truth).abs();
  const std::int64_t num_expression = error.size(-1) - kNumJaw;
  Losses losses{latent_loss,
                error.narrow(-1, 0, num_expression).mean(),
                error.narrow(-1, num_expression, kNumJaw).mean(),
                {}};
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

Tensor quantiser_loss(const Tensor& z, const Tensor& q) {
  return kCommitment * (q.detach() - z).square().mean() + (q - z.detach()).square().mean();
}

Tensor gaussian_divergence(const Tensor& mean, const Tensor& logvar) {
  return (0.5 * (logvar.exp() + mean.square() - 1 - logvar)).mean();
}

}  // namespace mien::train::probtalk3d
