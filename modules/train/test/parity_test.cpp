#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "mien/models/default/default_model.h"
#include "mien/train/default_model.h"

// The network is written once; these tests hold its two tensor libraries against each other, and LibTorch's
// gradients against central differences in double precision.
namespace mien::train {
namespace {

namespace fs = std::filesystem;
namespace dm = default_model;

// Largest difference of two results after float32 sums of a few hundred products: about ten times what is
// measured.
constexpr double kParityTolerance = 2e-5;

const dm::Sizes kSizes{24, 16, 32, 20, 12};

Network random_network(std::uint64_t seed) {
  Network network(kSizes);
  Initialise initialise(seed);
  network.visit(initialise);
  // Layers that start at zero would hide what is behind them.
  const torch::NoGradGuard no_grad;
  torch::manual_seed(4);
  for (const auto& e : parameters(network))
    e.slot->set_data(*e.slot + 0.1 * torch::randn_like(*e.slot)), e.slot->requires_grad_(false);
  network.statistics.face_sd.fill_(0.5);
  return network;
}

Tensor to_runtime(const torch::Tensor& x) {  // [1, N, D] -> [N, D]
  const auto flat = x.contiguous();
  return Tensor({x.size(1), x.size(2)}, {flat.data_ptr<float>(), static_cast<std::size_t>(flat.numel())});
}

void expect_same(const Tensor& got, const torch::Tensor& want, const char* what) {
  ASSERT_EQ(got.num_rows(), want.size(1)) << what;
  ASSERT_EQ(got.width(), want.size(2)) << what;
  const auto flat = want.contiguous();
  for (std::int64_t i = 0; i < got.count(); ++i)
    ASSERT_NEAR(got.data()[i], flat.data_ptr<float>()[i], kParityTolerance)
        << what << " row " << i / got.width() << " column " << i % got.width();
}

class Parity : public testing::Test {
 protected:
  void SetUp() override {
    const fs::path path =
        fs::path(testing::TempDir()) / ("mien_parity_" + std::to_string(::getpid()) + ".safetensors");
    dm::ModelMetadata metadata;
    metadata.sizes = kSizes;
    ASSERT_TRUE(save_parameters(parameters(torch_), path, false, dm::to_metadata(metadata)));
    auto model = DefaultModel::load(path);
    ASSERT_TRUE(model) << model.error().message();
    runtime_ = std::make_unique<DefaultModel>(std::move(*model));
    fs::remove(path);
  }
  dm::ConditionInput<torch::Tensor> condition() const {
    return {torch::rand({1, 1, dm::kStyleEntries}), torch::rand({1, 1, dm::kEmotionEntries}),
            torch::randn({1, 1, dm::kNumLatents})};
  }
  static dm::ConditionInput<Tensor> to_runtime_condition(const dm::ConditionInput<torch::Tensor>& c) {
    return {to_runtime(c.style), to_runtime(c.emotion), to_runtime(c.latents)};
  }
  torch::NoGradGuard no_grad_;
  Network torch_ = random_network(7);
  std::unique_ptr<DefaultModel> runtime_;
};

TEST_F(Parity, SpeechEncoderAndMeanPath) {
  const auto mel = torch::randn({1, 40, dm::kMelBands});
  const auto c = condition();
  const auto& r = runtime_->network();
  const auto hidden = torch_.encoder.encode_mel(mel, nullptr);
  expect_same(r.encoder.encode_mel(to_runtime(mel), nullptr), hidden, "encode_mel");
  const auto features = torch_.encoder.encode_frames(hidden, nullptr);
  expect_same(r.encoder.encode_frames(to_runtime(hidden), nullptr), features, "encode_frames");
  const auto mean = torch_.mean(features, torch_.mean.condition(c), nullptr);
  expect_same(r.mean(to_runtime(features), r.mean.condition(to_runtime_condition(c)), nullptr), mean, "mean");
  expect_same(r.encoder.events(to_runtime(features)), torch_.encoder.events(features), "events");
}

TEST_F(Parity, DiffusionPath) {
  constexpr std::int64_t kChunks = 5;
  const auto past = torch::randn({1, kChunks, dm::kChunkSamples * kNumUpper});
  const auto speech = torch::randn({1, kChunks, dm::kContextGroups * kSizes.width});
  const auto x_t = torch::randn({1, kChunks, dm::kChunkSamples * kNumUpper});
  const auto time = torch::randn({1, kChunks, dm::kNumTimeFeatures});
  const auto c = condition();
  const auto& r = runtime_->network();
  dm::DiffusionPath<torch::Tensor>::State state{torch::zeros({1, 1, kSizes.diffusion_hidden}),
                                                torch::zeros({1, 1, kSizes.diffusion_hidden})};
  dm::DiffusionPath<Tensor>::State runtime_state{Tensor({1, kSizes.diffusion_hidden}),
                                                 Tensor({1, kSizes.diffusion_hidden})};
  const auto h = torch_.diffusion.read(past, speech, torch_.diffusion.condition(c), state);
  expect_same(r.diffusion.read(to_runtime(past), to_runtime(speech),
                               r.diffusion.condition(to_runtime_condition(c)), runtime_state),
              h, "read");
  expect_same(runtime_state.second, state.second, "state");
  expect_same(r.diffusion.predict_x0(to_runtime(h), to_runtime(x_t), to_runtime(time)),
              torch_.diffusion.predict_x0(h, x_t, time), "predict_x0");
}

TEST_F(Parity, EventPaths) {
  const auto c = condition();
  const auto compare = [&](const dm::EventPath<torch::Tensor>& path, const dm::EventPath<Tensor>& runtime,
                           const char* what) {
    const dm::EventKind& kind = path.kind;
    const auto speech = torch::randn({1, 4, kind.groups * kSizes.width});
    const auto history = torch::rand({1, 4, kind.num_history()});
    auto state = torch::zeros({1, 1, path.hidden});
    Tensor runtime_state({1, runtime.hidden});
    const auto out = path(speech, history, path.condition(c), state);
    EXPECT_EQ(out.size(2), kind.num_outputs()) << what;
    expect_same(runtime(to_runtime(speech), to_runtime(history), runtime.condition(to_runtime_condition(c)),
                        runtime_state),
                out, what);
    expect_same(runtime_state, state, what);
  };
  compare(torch_.blink, runtime_->network().blink, "blink");
  compare(torch_.brow, runtime_->network().brow, "brow");
}

// d(sum of out * weights)/d(parameter) against central differences, for some elements of every parameter.
void expect_gradients(const std::vector<Collect::Entry>& entries,
                      const std::function<torch::Tensor()>& loss) {
  for (const auto& e : entries) e.slot->requires_grad_(e.trained);
  loss().backward();
  constexpr double kStep = 1e-6, kTolerance = 1e-6;
  for (const auto& e : entries) {
    if (!e.trained || !e.slot->grad().defined()) continue;
    const torch::Tensor gradient = e.slot->grad().flatten();
    for (const std::int64_t i : {std::int64_t{0}, e.slot->numel() / 2, e.slot->numel() - 1}) {
      const torch::NoGradGuard no_grad;
      double* value = e.slot->data_ptr<double>() + i;
      const double start = *value;
      *value = start + kStep;
      const double above = loss().item<double>();
      *value = start - kStep;
      const double below = loss().item<double>();
      *value = start;
      const double numeric = (above - below) / (2 * kStep);
      EXPECT_NEAR(gradient[i].item<double>(), numeric, kTolerance * std::max(1.0, std::abs(numeric)))
          << e.name << " " << i;
    }
  }
}

TEST(Gradients, EqualCentralDifferences) {
  Network network = random_network(11);
  for (const auto& e : parameters(network)) *e.slot = e.slot->detach().to(torch::kDouble);
  const auto options = torch::TensorOptions().dtype(torch::kDouble);
  const auto mel = torch::randn({2, 12, dm::kMelBands}, options);
  const dm::ConditionInput<torch::Tensor> c{torch::rand({2, 1, dm::kStyleEntries}, options),
                                            torch::rand({2, 1, dm::kEmotionEntries}, options),
                                            torch::randn({2, 1, dm::kNumLatents}, options)};
  const auto past = torch::randn({2, 3, dm::kChunkSamples * kNumUpper}, options);
  const auto speech = torch::randn({2, 3, dm::kContextGroups * kSizes.width}, options);
  const auto time = torch::randn({2, 3, dm::kNumTimeFeatures}, options);
  const auto blink_history = torch::rand({2, 3, dm::kBlinks.num_history()}, options);
  const auto brow_speech = torch::randn({2, 3, kSizes.width}, options);
  const auto brow_history = torch::rand({2, 3, dm::kBrowRaises.num_history()}, options);
  const auto zeros = [&](std::int64_t width) { return torch::zeros({2, 1, width}, options); };
  expect_gradients(parameters(network), [&] {
    const auto features = network.encoder.encode_frames(network.encoder.encode_mel(mel, nullptr), nullptr);
    const auto mean = network.mean(features, network.mean.condition(c), nullptr);
    dm::DiffusionPath<torch::Tensor>::State state{zeros(kSizes.diffusion_hidden),
                                                  zeros(kSizes.diffusion_hidden)};
    const auto h = network.diffusion.read(past, speech, network.diffusion.condition(c), state);
    const auto x0 = network.diffusion.predict_x0(h, past, time);
    auto blink_state = zeros(kSizes.blink_hidden), brow_state = zeros(kSizes.brow_hidden);
    const auto blink = network.blink(speech, blink_history, network.blink.condition(c), blink_state);
    const auto brow = network.brow(brow_speech, brow_history, network.brow.condition(c), brow_state);
    return mean.square().mean() + x0.square().mean() + torch::log_softmax(blink, -1).mean() +
           brow.square().mean() + network.encoder.visemes(features).square().mean() +
           network.encoder.events(features).square().mean();
  });
}

}  // namespace
}  // namespace mien::train
