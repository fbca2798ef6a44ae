#include "mien/train/said_training.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>

#include "mien/train/optimiser.h"
#include "small_encoder_config.h"

namespace mien::train {
namespace {

namespace fs = std::filesystem;
constexpr std::int64_t kWidth = 4;

EncoderConfig small_encoder() { return small_encoder_config(2); }

// The norms have 32 groups: from 64 channels on a group has more than one, and what a step adds to a channel
// is not taken out again.
said::Sizes small_sizes(std::int64_t width = 32) {
  said::Sizes s;
  s.num_channels = kWidth;
  s.width = width;
  s.context = s.speech = 16;
  s.time = 32;
  s.inner = 32;
  return s;
}

// A tone that comes and goes; the coefficients follow its loudness.
std::vector<CoefficientSequence> sequences(int count) {
  std::vector<CoefficientSequence> all;
  for (int i = 0; i < count; ++i) {
    CoefficientSequence s{"sequence " + std::to_string(i), {}, {}};
    const auto loud = [&](double seconds) { return 0.5 + 0.5 * std::sin((7.0 + i) * seconds); };
    const int num_frames = 60 + 4 * i;
    for (int n = 0; n < num_frames; ++n)
      for (int k = 0; k < kWidth; ++k)
        s.coefficients.push_back(static_cast<float>(0.2 + (0.1 + 0.1 * k) * loud(n / 60.0)));
    for (int n = 0; n < num_frames * 16000 / 60; ++n)
      s.waveform.push_back(static_cast<float>(0.4 * loud(n / 16000.0) * std::sin(2000 * n / 16000.0)));
    all.push_back(std::move(s));
  }
  return all;
}

SaidTrainingOptions small_options() {
  SaidTrainingOptions o;
  o.batch = 4;
  o.shortest_window = 24;
  o.diffusion_steps = 50;
  o.encoder_dropout = o.layer_drop = o.spec_augment = false;
  o.dropout = 0;
  return o;
}

struct SmallRun {
  explicit SmallRun(const SaidTrainingOptions& options = small_options(), bool freezes = true,
                    const said::Sizes& sizes = small_sizes())
      : network{SpeechEncoder<torch::Tensor>(small_encoder()), said::Network<torch::Tensor>(sizes)} {
    initialise_as_published(network, 3);
    for (const auto& e : parameters(network)) *e.slot = e.slot->detach();
    learning = freezes ? parameters(network.head) : parameters(network);
    for (const auto& e : learning) e.slot->requires_grad_(true);
    stage.emplace(network, sequences(6), std::vector<std::size_t>{0, 2, 1, 3}, options);
  }
  void train(std::int64_t until, const fs::path& checkpoint, double rate = 3e-3) {
    Progress progress;
    const auto done = run_stage(
        "said", learning, StageOptions::warm_adamw(until, rate, 5, 0.99), checkpoint,
        [&](std::int64_t step) -> Result<torch::Tensor> { return stage->loss(step); }, progress,
        [&](const StepReport& r) { losses.push_back(r.loss); });
    ASSERT_TRUE(done) << done.error().message();
  }
  SaidNetwork network;
  std::vector<Collect::Entry> learning;
  std::optional<SaidStage> stage;
  std::vector<double> losses;
};

class SaidTraining : public testing::Test {
 protected:
  SaidTraining()
      : checkpoint_(fs::path(testing::TempDir()) /
                    ("said_" + std::to_string(::getpid()) + "_" +
                     testing::UnitTest::GetInstance()->current_test_info()->name() + ".safetensors")) {
    torch::set_num_threads(1);
  }
  ~SaidTraining() override { fs::remove(checkpoint_); }
  fs::path checkpoint_;
};

// Root of the share of what is left of a curve at a step, and of the noise: specification, section 4.1.
std::pair<double, double> level_of(std::int64_t step, int num_steps) {
  const auto a = [&](double i) { return std::pow(std::cos((i / num_steps + 0.008) / 1.008 * M_PI / 2), 2); };
  double kept = 1;
  for (std::int64_t i = 0; i <= step; ++i)
    kept *= 1 - std::min(1 - a(static_cast<double>(i) + 1) / a(static_cast<double>(i)), 0.999);
  return {std::sqrt(kept), std::sqrt(1 - kept)};
}

// What the trained network says of noise that this test adds by itself, to curves whose sound it hears, hears
// that of another curve, or does not hear. [mean |estimate - noise| of each]
struct Heard {
  double own = 0, other = 0, none = 0;
};
Heard heard_at(SaidNetwork& network, std::int64_t step) {
  const torch::NoGradGuard no_grad;
  const auto [left, added] = level_of(step, 50);
  const auto all = sequences(6);
  const auto context_of = [&](const CoefficientSequence& s, std::int64_t num_frames) {
    std::vector<float> sound(s.waveform.begin(), s.waveform.begin() + 16000);
    normalise_waveform(sound, network.encoder.config.normalise_eps);
    EncoderCall call;
    call.num_frames = num_frames;
    const auto features = network.encoder.extract(torch::tensor(sound).reshape({1, -1, 1}));
    return network.head.context(network.encoder.transform(network.encoder.project(features, call), call));
  };
  Heard error;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto num_frames = std::int64_t{60};
    const auto x0 = torch::tensor(all[i].coefficients).reshape({1, -1, kWidth}).slice(1, 0, num_frames);
    torch::Tensor noise = torch::empty_like(x0);
    NoiseField(i, 99).normal(static_cast<std::uint64_t>(step), 0,
                             {noise.data_ptr<float>(), static_cast<std::size_t>(noise.numel())});
    const torch::Tensor context = context_of(all[i], num_frames);
    const auto off = [&](const torch::Tensor& heard) {
      const auto made =
          network.head.denoiser(left * x0 + added * noise, std::vector<std::int64_t>{step}, heard);
      return (made - noise).abs().mean().item<double>() / static_cast<double>(all.size());
    };
    error.own += off(context);
    error.other += off(context_of(all[(i + 3) % all.size()], num_frames));
    error.none += off(network.head.null_context(context));
  }
  return error;
}

// Against noise, sound and levels of the test's own: training and validation err alike where they share code.
TEST_F(SaidTraining, NoiseIsLearnt) {
  SaidTrainingOptions options = small_options();
  options.mirror_probability = 0;
  SmallRun run(options);
  const double untrained = heard_at(run.network, 20).own;
  EXPECT_NEAR(untrained, std::sqrt(2 / M_PI), 0.05) << "of |N(0, 1)|";
  run.train(300, checkpoint_);
  for (const std::int64_t step : {10, 20, 30, 40})
    EXPECT_LT(heard_at(run.network, step).own, 0.3 * untrained) << "step " << step;
  const Heard error = heard_at(run.network, 10);
  EXPECT_LT(error.own, 0.92 * error.other);
  EXPECT_LT(error.own, 0.95 * error.none);
}

// Each window has the noise of its own step, and the network is told that step.
TEST_F(SaidTraining, EstimatesFromTheNoiseOfTheStepThatItTells) {
  SmallRun run(small_options(), /*freezes=*/true, small_sizes(64));
  const torch::NoGradGuard no_grad;
  torch::manual_seed(5);
  for (const auto& e : run.learning)
    e.slot->add_(0.1 * torch::randn_like(*e.slot));  // so that it says something
  const auto size = [](const torch::Tensor& x) { return x.abs().max().item<double>(); };
  int num_windows = 0;
  for (std::int64_t step = 0; step < 4; ++step) {
    SaidBatch batch = run.stage->draw(step);
    batch.conditioned.assign(batch.steps.size(), 1);
    const torch::Tensor features = run.stage->encode(batch, nullptr),
                        made = run.stage->estimate(batch, features, false);
    EXPECT_TRUE(torch::equal(run.stage->estimate(batch, features, true), made)) << "dropout is 0";
    for (std::size_t i = 0; i < batch.steps.size(); ++i, ++num_windows) {
      const auto own = [&](const torch::Tensor& all) {
        return all.narrow(0, static_cast<std::int64_t>(i), 1);
      };
      const auto [left, added] = level_of(batch.steps[i], 50);
      const auto told = [&](std::int64_t t) {
        return run.network.head.denoiser(left * own(batch.coefficients) + added * own(batch.noise),
                                         std::vector<std::int64_t>{t},
                                         run.network.head.context(own(features)));
      };
      const torch::Tensor want = told(batch.steps[i]);
      EXPECT_LT(size(own(made) - want), 1e-4 * size(want)) << "step " << batch.steps[i];
      EXPECT_GT(size(told((batch.steps[i] + 10) % 50) - want), 1e-2 * size(want)) << "the step says nothing";
    }
  }
  EXPECT_EQ(num_windows, 12);
}

TEST_F(SaidTraining, AReportShowsTheAverageAndGoesOnFromTheWeights) {
  SmallRun run, undisturbed;
  Progress progress;
  torch::Tensor shown;
  const auto done = run_stage(
      "said", run.learning, StageOptions::warm_adamw(8, 3e-3, 2, 0.99), checkpoint_,
      [&](std::int64_t step) -> Result<torch::Tensor> { return run.stage->loss(step); }, progress,
      [&](const StepReport& r) {
        run.losses.push_back(r.loss);
        r.with_average([&] { shown = run.network.head.denoiser.input.weight.detach().clone(); });
      });
  ASSERT_TRUE(done) << done.error().message();
  EXPECT_TRUE(torch::equal(shown, run.network.head.denoiser.input.weight)) << "of the last step: delivered";
  fs::remove(checkpoint_);
  Progress again;
  ASSERT_TRUE(run_stage(
      "said", undisturbed.learning, StageOptions::warm_adamw(8, 3e-3, 2, 0.99), checkpoint_,
      [&](std::int64_t step) -> Result<torch::Tensor> { return undisturbed.stage->loss(step); }, again,
      [&](const StepReport& r) { undisturbed.losses.push_back(r.loss); }));
  EXPECT_EQ(run.losses, undisturbed.losses);
}

TEST_F(SaidTraining, BeginsAsPyTorchDoes) {
  SmallRun run;
  int num_drawn = 0;
  for (const auto& e : run.learning) {
    const double most = e.slot->abs().max().item<double>();
    if (e.name.find("norm") != std::string::npos || e.name.find("in_layers.0") != std::string::npos) {
      EXPECT_EQ(most, e.name.ends_with(".weight") ? 1 : 0) << e.name;
    } else if (e.name.ends_with("time_embed.0.bias")) {
      // 32 inputs: uniform in +-0.177, so the largest of 32 numbers is close to it
      EXPECT_LE(most, 1 / std::sqrt(32.0));
      EXPECT_GT(most, 0.5 / std::sqrt(32.0));
      ++num_drawn;
    } else if (e.name == "null_cond_emb") {
      EXPECT_GT(most, 0.5);
      ++num_drawn;
    }
  }
  EXPECT_EQ(num_drawn, 2);
}

TEST_F(SaidTraining, AnUntrainedNetworkSaysNothing) {
  SmallRun run;
  const torch::NoGradGuard no_grad;
  const SaidBatch batch = run.stage->draw(0);
  const torch::Tensor made = run.stage->estimate(batch, run.stage->encode(batch, nullptr), false);
  EXPECT_EQ(made.abs().max().item<double>(), 0);
  const SaidLoss loss = run.stage->loss_of(batch, made);
  EXPECT_NEAR(loss.prediction.item<double>(), std::sqrt(2 / M_PI), 0.1) << "of |N(0, 1)|";
}

TEST_F(SaidTraining, GoesOnAfterAnInterruptionWithTheSameLosses) {
  SaidTrainingOptions random = small_options();
  random.encoder_dropout = random.layer_drop = random.spec_augment = true;
  random.dropout = 0.1;
  SmallRun whole(random), first(random), second(random), certain;
  whole.train(6, checkpoint_);
  fs::remove(checkpoint_);
  first.train(3, checkpoint_);
  second.train(6, checkpoint_);
  first.losses.insert(first.losses.end(), second.losses.begin(), second.losses.end());
  EXPECT_EQ(first.losses, whole.losses);
  fs::remove(checkpoint_);
  certain.train(6, checkpoint_);
  EXPECT_NE(certain.losses, whole.losses);
}

TEST_F(SaidTraining, DrawsWindowsMirrorsAndConditionsAsAsked) {
  SaidTrainingOptions options = small_options();
  options.mirror_probability = 1;
  options.unconditional_probability = 0.25;
  SmallRun mirrored(options), plain([] {
    SaidTrainingOptions o = small_options();
    o.mirror_probability = 0;
    o.unconditional_probability = 0.25;
    return o;
  }());
  EXPECT_EQ(mirrored.stage->steps_per_epoch(), 2);
  int without = 0, count = 0;
  std::int64_t shortest = 1000, longest = 0;
  for (std::int64_t step = 0; step < 200; ++step) {
    const SaidBatch batch = mirrored.stage->draw(step);
    EXPECT_EQ(batch.coefficients.size(0), step % 2 == 0 ? 4 : 2) << "six sequences in batches of four";
    EXPECT_EQ(batch.waveform.size(1), batch.coefficients.size(1) * 16000 / 60);
    shortest = std::min(shortest, batch.coefficients.size(1));
    longest = std::max(longest, batch.coefficients.size(1));
    for (const auto c : batch.conditioned) without += c == 0 ? 1 : 0, ++count;
    for (const auto t : batch.steps) EXPECT_TRUE(t >= 0 && t < 50);
    const torch::Tensor original = plain.stage->draw(step).coefficients;
    EXPECT_TRUE(torch::equal(batch.coefficients.select(2, 1), original.select(2, 2)));
    EXPECT_TRUE(torch::equal(batch.coefficients.select(2, 3), original.select(2, 3)));
  }
  EXPECT_NEAR(static_cast<double>(without) / count, 0.25, 0.07);
  EXPECT_LE(shortest, 26);
  EXPECT_GE(longest, 60);
  EXPECT_LE(longest, 80);
}

TEST_F(SaidTraining, TheSoundMattersOnlyWhereAWindowIsConditioned) {
  SmallRun run;
  const torch::NoGradGuard no_grad;
  for (const auto& e : run.learning) e.slot->add_(0.05);  // so that it says something
  SaidBatch batch = run.stage->draw(0);
  batch.conditioned = {1, 0, 1, 0};
  const torch::Tensor features = run.stage->encode(batch, nullptr),
                      one = run.stage->estimate(batch, features, false),
                      other = run.stage->estimate(batch, features.flip({1}), false);
  for (std::int64_t i = 0; i < 4; ++i) EXPECT_EQ(torch::equal(one[i], other[i]), i % 2 == 1) << i;
}

TEST_F(SaidTraining, FineTunesTheEncoderWhereItLearns) {
  SmallRun frozen, tuned(small_options(), /*freezes=*/false);
  const auto kept = frozen.network.encoder.layers[0].output_dense.weight.clone();
  frozen.train(3, checkpoint_);
  EXPECT_TRUE(torch::equal(frozen.network.encoder.layers[0].output_dense.weight, kept));
  fs::remove(checkpoint_);
  tuned.train(12, checkpoint_);  // the denoiser must first listen: its last layers begin at zero
  EXPECT_FALSE(torch::equal(tuned.network.encoder.layers[0].output_dense.weight, kept));
}

TEST_F(SaidTraining, OptionsChangeTheLoss) {
  const torch::Tensor made = torch::tensor({1.f, 2.f, 4.f, 2.f}).reshape({1, 2, 2}),
                      target = torch::zeros({1, 2, 2});
  const SaidLoss absolute = said_loss(made, target, {}),
                 squared = said_loss(made, target, {.is_squared = true}),
                 divided = said_loss(made, target, {.deviation = torch::tensor({1.f, 2.f})});
  EXPECT_FLOAT_EQ(absolute.prediction.item<float>(), 2.25f);
  EXPECT_FLOAT_EQ(absolute.velocity.item<float>(), 1.5f);
  EXPECT_FLOAT_EQ(squared.prediction.item<float>(), 6.25f);
  EXPECT_FLOAT_EQ(squared.velocity.item<float>(), 4.5f);
  EXPECT_FLOAT_EQ(divided.prediction.item<float>(), 1.75f);
}

TEST_F(SaidTraining, RefusesToValidateOnNothingButAFrame) {
  SmallRun run;
  auto one = sequences(1);
  one[0].coefficients.resize(kWidth);
  const auto loss = run.stage->validation_loss(one, 1, 1);
  ASSERT_FALSE(loss);
  EXPECT_NE(loss.error().message().find("sequence 0"), std::string::npos);
  EXPECT_EQ(*run.stage->validation_loss({}, 1, 1), 0);
}

}  // namespace
}  // namespace mien::train
