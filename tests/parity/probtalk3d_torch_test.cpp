// ProbTalk3D on LibTorch: the suite, and the losses and gradients of both motion priors.
#include <gtest/gtest.h>
#include <torch/torch.h>

#include "mien/train/probtalk3d_losses.h"
#include "mien/train/torch_parameters.h"
#include "probtalk3d_suite.h"
#include "torch_backend.h"

namespace mien::parity {

namespace {

using train::Collect;
using train::probtalk3d::Losses;
namespace losses = train::probtalk3d;

MIEN_PROBTALK3D_SUITE(TorchProbTalk3D, torch::Tensor)

void expect_scalar(const torch::Tensor& got, const Fixture& recorded, const std::string& name) {
  SCOPED_TRACE(name);
  const double want = recorded.tensor(name).values()[0];
  EXPECT_NEAR(got.item<double>(), want, 1e-6 + 1e-5 * std::abs(want));
}

double weight_in(const Fixture& recorded, const std::string& name) {
  return std::stod(recorded.metadata(name));
}

void expect_gradient(const torch::Tensor& got, const Fixture& recorded, const std::string& name) {
  SCOPED_TRACE(name);
  ASSERT_TRUE(got.defined()) << "no gradient";
  const mien::Tensor want = recorded.tensor("grad." + name);
  MIEN_EXPECT_CLOSE(Backend<torch::Tensor>::values(got.reshape({1, -1})), want.reshaped({1, want.count()}),
                    "motion gradient");
}

// Every recorded gradient belongs to a parameter or to z or z_q, and is what backward() gives.
void expect_gradients(const std::vector<Collect::Entry>& entries, const Fixture& recorded,
                      std::size_t num_others) {
  std::size_t num_recorded = 0, num_found = 0;
  for (const auto& stored : recorded.file().tensors())
    num_recorded += stored.name.starts_with("grad.") ? 1 : 0;
  for (const auto& entry : entries) {
    if (!recorded.has("grad." + entry.name)) continue;
    expect_gradient(entry.slot->grad(), recorded, entry.name);
    ++num_found;
  }
  EXPECT_EQ(num_found + num_others, num_recorded) << "a recorded gradient has no parameter";
}

TEST(TorchProbTalk3D, QuantisedPriorHasTheRecordedLossesAndGradients) {
  replay_file("vqvae_stage1.safetensors", [](const std::string& file) {
    const Fixture recorded("probtalk3d", file);
    auto prior = recorded_network<torch::Tensor>(
        recorded, probtalk3d::MotionPrior<torch::Tensor>(recorded_sizes(recorded)));
    const auto entries = train::parameters(prior);
    for (const auto& entry : entries) entry.slot->requires_grad_(true);
    const torch::Tensor motion = recorded_rows<torch::Tensor>(recorded, "in.motion");
    const torch::Tensor z = prior.encoder(motion);
    const auto latent = losses::quantise(prior.quantiser, z);
    EXPECT_EQ(latent.codes, recorded.integers("mid.indices"));
    z.retain_grad(), latent.z_q.retain_grad();
    const losses::LossWeights weights{weight_in(recorded, "lambda_quant"), weight_in(recorded, "lambda_exp"),
                                      weight_in(recorded, "lambda_jaw")};
    EXPECT_EQ(weight_in(recorded, "beta"), losses::kCommitment);
    EXPECT_EQ(weights.latent, losses::kQuantisedPrior.latent);
    const Losses loss = losses::motion_losses(losses::quantiser_loss(z, latent.q), prior.decoder(latent.z_q),
                                              motion, weights);
    expect_scalar(loss.latent, recorded, "loss.quant");
    expect_scalar(loss.expression, recorded, "loss.recons_exp");
    expect_scalar(loss.jaw, recorded, "loss.recons_jaw");
    expect_scalar(loss.total, recorded, "loss.total");
    loss.total.backward();
    expect_gradient(z.grad(), recorded, "z");
    expect_gradient(latent.z_q.grad(), recorded, "z_q");
    expect_gradients(entries, recorded, 2);
  });
}

TEST(TorchProbTalk3D, GaussianPriorHasTheRecordedLossesAndGradients) {
  replay_file("vae_stage1.safetensors", [](const std::string& file) {
    const Fixture recorded("probtalk3d", file);
    auto prior = recorded_network<torch::Tensor>(
        recorded, probtalk3d::MotionPrior<torch::Tensor>(recorded_sizes(recorded)));
    const auto entries = train::parameters(prior);
    for (const auto& entry : entries) entry.slot->requires_grad_(true);
    const torch::Tensor motion = recorded_rows<torch::Tensor>(recorded, "in.motion"),
                        z = prior.encoder(motion);
    const torch::Tensor mean = prior.mean(z), logvar = prior.logvar(z);
    const torch::Tensor latent =
        probtalk3d::gaussian_sample(mean, logvar, recorded_rows<torch::Tensor>(recorded, "in.eps"));
    const losses::LossWeights weights{weight_in(recorded, "lambda_kl"), weight_in(recorded, "lambda_exp"),
                                      weight_in(recorded, "lambda_jaw")};
    EXPECT_EQ(weights.latent, losses::kGaussianPrior.latent);
    const Losses loss = losses::motion_losses(losses::gaussian_divergence(mean, logvar),
                                              prior.decoder(latent), motion, weights);
    expect_scalar(loss.latent, recorded, "loss.kl");
    expect_scalar(loss.expression, recorded, "loss.recons_exp");
    expect_scalar(loss.jaw, recorded, "loss.recons_jaw");
    expect_scalar(loss.total, recorded, "loss.total");
    loss.total.backward();
    std::size_t num_others = 0;
    for (const char* name : {"z", "latent", "mean", "logvar"})
      num_others += recorded.has(std::string("grad.") + name);
    expect_gradients(entries, recorded, num_others);
  });
}

}  // namespace
}  // namespace mien::parity
