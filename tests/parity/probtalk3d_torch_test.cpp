// ProbTalk3D on LibTorch: the suite, and the losses and gradients of both motion priors, of the predictor and
// of the emotional FaceDiffuser.
#include <gtest/gtest.h>
#include <torch/torch.h>
#include <unistd.h>

#include "emotional_case.h"
#include "mien/models/model_file.h"
#include "mien/train/face_network.h"
#include "mien/train/optimiser.h"
#include "mien/train/probtalk3d_losses.h"
#include "mien/train/torch_parameters.h"
#include "probtalk3d_suite.h"
#include "torch_backend.h"

namespace mien::parity {

INSTANTIATE_TYPED_TEST_SUITE_P(LibTorch, ProbTalk3DNetworks, torch::Tensor);

namespace {

using train::Collect;
using train::probtalk3d::Losses;
namespace losses = train::probtalk3d;

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

struct RecordedPrior {
  const char* file;
  const char* latent;         // the loss of the latent, and its weight
  const char* latent_weight;  //
  losses::LossWeights published;
};

TEST(TorchProbTalk3D, BothPriorsHaveTheRecordedLossesAndGradients) {
  for (const RecordedPrior& c :
       {RecordedPrior{"vqvae_stage1.safetensors", "loss.quant", "lambda_quant", losses::kQuantisedPrior},
        RecordedPrior{"vae_stage1.safetensors", "loss.kl", "lambda_kl", losses::kGaussianPrior}})
    replay_file(c.file, [&](const std::string& file) {
      const Fixture recorded("probtalk3d", file);
      auto prior = recorded_network<torch::Tensor>(
          recorded, probtalk3d::MotionPrior<torch::Tensor>(recorded_sizes(recorded)));
      const auto entries = train::parameters(prior);
      for (const auto& entry : entries) entry.slot->requires_grad_(true);
      const torch::Tensor motion = recorded_rows<torch::Tensor>(recorded, "in.motion");
      losses::PriorOptions options;
      options.weights = {weight_in(recorded, c.latent_weight), weight_in(recorded, "lambda_exp"),
                         weight_in(recorded, "lambda_jaw")};
      EXPECT_EQ(options.weights.latent, c.published.latent);
      EXPECT_EQ(options.weights.expression, c.published.expression);
      EXPECT_EQ(options.weights.jaw, c.published.jaw);
      options.jaw = losses::flame_jaw(motion.size(-1));
      torch::Tensor noise;
      if (prior.sizes.is_variational())
        noise = recorded_rows<torch::Tensor>(recorded, "in.eps");
      else
        EXPECT_EQ(weight_in(recorded, "beta"), losses::kCommitment);
      losses::PriorPass pass = losses::pass_prior(prior, motion, noise, options);
      for (auto* tensor : {&pass.z, &pass.latent.values, &pass.latent.mean, &pass.latent.logvar})
        if (tensor->defined()) tensor->retain_grad();
      expect_scalar(pass.losses.latent, recorded, c.latent);
      expect_scalar(pass.losses.expression, recorded, "loss.recons_exp");
      expect_scalar(pass.losses.jaw, recorded, "loss.recons_jaw");
      expect_scalar(pass.losses.total, recorded, "loss.total");
      pass.losses.total.backward();
      if (!prior.sizes.is_variational()) {
        EXPECT_EQ(pass.latent.codes.codes, recorded.integers("mid.indices"));
      }
      std::size_t num_others = 0;  // gradients of what is no parameter
      const auto expect_other = [&](const char* name, const torch::Tensor& of) {
        if (!recorded.has(std::string("grad.") + name)) return;
        ++num_others;
        expect_gradient(of.grad(), recorded, name);
      };
      expect_other("z", pass.z);
      expect_other("z_q", pass.latent.values);
      expect_other("latent", pass.latent.values);
      expect_other("mean", pass.latent.mean);
      expect_other("logvar", pass.latent.logvar);
      expect_gradients(entries, recorded, num_others);
    });
}

// Speech encoder, predictor and prior as one network: parameters as in a stage-2 checkpoint.
struct Stage2 {
  SpeechEncoder<torch::Tensor> encoder;
  probtalk3d::Network<torch::Tensor> network;
  template <class V>
  void visit(V& v) {
    v.scope("feature_extractor.audiomodel", encoder);
    network.visit(v);
  }
};

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  for (std::size_t start = 0; start < text.size();) {
    const auto end = std::min(text.find(separator, start), text.size());
    parts.push_back(text.substr(start, end - start));
    start = end + 1;
  }
  return parts;
}

TEST(TorchProbTalk3D, PredictorHasTheRecordedLossesAndGradients) {
  replay_file("stage2_training.safetensors", [](const std::string& file) {
    const Fixture recorded("probtalk3d", file), inputs("probtalk3d", weights_of(recorded));
    Stage2 stage = recorded_network<torch::Tensor>(
        inputs,
        Stage2{SpeechEncoder<torch::Tensor>(taken(encoder_config_from_json(inputs.metadata("hubert")))),
               probtalk3d::Network<torch::Tensor>(recorded_sizes(inputs))});
    std::vector<std::string> frozen = {"motion_prior"};
    for (const std::string& name : train::published_frozen())
      frozen.push_back("feature_extractor.audiomodel." + name.substr(ModelFile::kEncoderPrefix.size()));
    auto learning = taken(train::freeze(train::parameters(stage), frozen));
    auto recorded_frozen = split(inputs.metadata("frozen_in_training"), ';');
    recorded_frozen.pop_back();  // the text was cut
    for (const auto& entry : learning)
      EXPECT_EQ(std::ranges::count(recorded_frozen, entry.name), 0) << entry.name << " was frozen";
    // In place of masked frames, and none is masked.
    std::erase_if(learning, [](const auto& e) { return e.name.ends_with("masked_spec_embed"); });
    for (const auto& entry : learning) entry.slot->requires_grad_(true);

    const mien::Tensor waveform = inputs.tensor("mid.input_values");
    const torch::Tensor pairs =
        paired(stage.encoder(Backend<torch::Tensor>::given(waveform.reshaped({waveform.count(), 1}))));
    const std::int64_t num_frames = pairs.size(1);
    const torch::Tensor truth =
        recorded_rows<torch::Tensor>(recorded, "in.motion_gt").narrow(1, 0, num_frames);
    MIEN_EXPECT_CLOSE(Backend<torch::Tensor>::values(truth), recorded.tensor("mid.motion_gt_trimmed"),
                      "motion");
    const auto& prior = stage.network.prior;
    const auto reference = losses::quantise(prior.quantiser, prior.encoder(truth));
    expect_codes(reference.codes, recorded, "mid.indices_ref", "mid.margins_ref");
    MIEN_EXPECT_CLOSE(Backend<torch::Tensor>::values(reference.z_q), recorded.tensor("mid.z_q_ref"),
                      "motion stage");
    const torch::Tensor predicted = stage.network.predictor(pairs, style_of<torch::Tensor>(inputs));
    MIEN_EXPECT_CLOSE(Backend<torch::Tensor>::values(predicted), inputs.tensor("mid.z_a"), "motion stage");
    // Where both sides have the same code, their difference is a rounding, and the gradient of its absolute
    // value is the sign of that: it is compared at the recorded latents, and carried on from there.
    const torch::Tensor z = recorded_rows<torch::Tensor>(inputs, "mid.z_a").requires_grad_(true);
    const torch::Tensor z_q_of_truth = recorded_rows<torch::Tensor>(recorded, "mid.z_q_ref");
    const auto heard = losses::quantise(prior.quantiser, z);
    heard.z_q.retain_grad();
    const losses::LossWeights weights{weight_in(recorded, "lambda_latent"), weight_in(recorded, "lambda_exp"),
                                      weight_in(recorded, "lambda_jaw")};
    EXPECT_EQ(weights.expression, losses::kPredictor.expression);
    const Losses loss =
        losses::motion_losses((heard.z_q - z_q_of_truth).abs().mean(), prior.decoder(heard.z_q), truth,
                              weights, losses::flame_jaw(truth.size(-1)));
    expect_scalar(loss.latent, recorded, "loss.latent");
    expect_scalar(loss.expression, recorded, "loss.recons_exp");
    expect_scalar(loss.jaw, recorded, "loss.recons_jaw");
    expect_scalar(loss.total, recorded, "loss.total");
    loss.total.backward();
    expect_gradient(z.grad(), recorded, "z_a");
    expect_gradient(heard.z_q.grad(), recorded, "z_q");
    predicted.backward(z.grad());
    for (const auto& entry : learning) EXPECT_TRUE(recorded.has("grad." + entry.name)) << entry.name;
    expect_gradients(learning, recorded, 2);
  });
}

TEST(TorchProbTalk3D, EmotionalDiffuserHasTheRecordedLossAndGradients) {
  for_each_case("probtalk3d", "", EmotionalCase<torch::Tensor>::kSampling, [](const std::string& name) {
    EmotionalCase<torch::Tensor> c(name);
    const auto entries = train::parameters(c.network);
    for (const auto& entry : entries) entry.slot->requires_grad_(true);
    c.condition();  // again, so that gradients reach what makes the conditions
    const auto x_t = Backend<torch::Tensor>::given(c.forward.tensor("mid.x_t"));
    const torch::Tensor predicted = c.network.predict_x0(x_t, c.given, c.forward.integers("in.t").at(0));
    const torch::Tensor loss = torch::huber_loss(
        predicted, Backend<torch::Tensor>::given(c.forward.tensor("in.x0")), at::Reduction::Mean, 1.0);
    expect_scalar(loss, c.forward, "loss.huber");
    loss.backward();
    for (const auto& entry : entries) EXPECT_TRUE(c.forward.has("grad." + entry.name)) << entry.name;
    expect_gradients(entries, c.forward, 0);
  });
}

// The gradients are given: those of the sum of parameters times them.
TEST(TorchProbTalk3D, OptimisersStepAsRecorded) {
  replay_file("optim.safetensors", [](const std::string& file) {
    const Fixture recorded("probtalk3d", file);
    const std::int64_t num_steps = recorded.file().find("in.grads")->shape.at(0);
    const auto expect = [&](const std::string& name, double rate, double beta2, double epsilon,
                            double weight_decay) {
      SCOPED_TRACE(name);
      torch::Tensor parameter = Backend<torch::Tensor>::parameter(recorded.tensor("in.param"));
      auto options = train::StageOptions::plain_adam(num_steps, rate);
      options.beta2 = beta2;
      options.epsilon = epsilon;
      options.weight_decay = weight_decay;
      options.decays_vectors = true;
      const auto checkpoint = std::filesystem::path(testing::TempDir()) /
                              ("mien_optim_" + std::to_string(getpid()) + ".safetensors");
      std::filesystem::remove(checkpoint);
      Progress progress;
      const auto gradient = [&](std::int64_t step) {
        return Backend<torch::Tensor>::parameter(recorded.slice("in.grads", step));
      };
      const Status done = train::run_stage(
          name, {{"parameter", &parameter, true}}, options, checkpoint,
          [&](std::int64_t step) -> Result<torch::Tensor> { return (parameter * gradient(step)).sum(); },
          progress,
          [&](const train::StepReport& r) {
            MIEN_EXPECT_CLOSE(Backend<torch::Tensor>::values(parameter), recorded.slice(name, r.step),
                              "optimiser");
          });
      EXPECT_TRUE(done) << done.error().message();
      std::filesystem::remove(checkpoint);
    };
    expect("out.adamw", 1e-4, 0.98, 1e-9, 0.01);
    expect("out.adam", 1e-5, 0.98, 1e-9, 0);
    expect("out.adam_facediffuser", 1e-4, 0.999, 1e-8, 0);
  });
}

}  // namespace
}  // namespace mien::parity
