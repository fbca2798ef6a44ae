#include "mien/train/said_vae_training.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <numeric>

#include "mien/train/optimiser.h"

namespace mien::train {
namespace {

namespace fs = std::filesystem;
constexpr std::int64_t kWidth = 4;

said::VaeSizes small_sizes() {
  said::VaeSizes s;
  s.window = 24;
  s.channels = kWidth;
  s.latent = 6;
  s.encoder_convs = {{{kWidth, 8, 3}, {8, 8, 3}, {8, 8, 4}, {8, 4, 3}}};
  s.encoder_widths = {24, 16, 8};
  s.decoder_width = 16;
  s.decoder_convs = {{{2, 8, 3}, {8, 8, 3}, {8, 8, 3}, {8, kWidth, 3}}};
  return s;
}

// Curves that open and close, each sequence at a rate of its own.
std::vector<CoefficientSequence> sequences(int count) {
  std::vector<CoefficientSequence> all;
  for (int i = 0; i < count; ++i) {
    CoefficientSequence s{"sequence " + std::to_string(i), {}, {}};
    for (int n = 0; n < 70 + 5 * i; ++n)
      for (int k = 0; k < kWidth; ++k)
        s.coefficients.push_back(static_cast<float>(0.4 + 0.3 * std::sin(0.15 * (i + 2) * n / 2 + k)));
    all.push_back(std::move(s));
  }
  return all;
}

VaeTrainingOptions small_options() {
  VaeTrainingOptions o;
  o.num_epochs = 300;
  o.batch = 4;
  o.num_cycles = 3;
  o.highest_weight = 0.01;
  return o;
}

struct TrainingRun {
  TrainingRun() { initialise_as_pytorch(vae, 3); }
  // Steps from where the checkpoint is up to `until`.
  void train(std::int64_t until, const fs::path& checkpoint, std::int64_t warm_up = 10) {
    auto options = StageOptions::warm_adamw(until, 5e-3, warm_up, 0.99);
    options.keeps_buffers = true;
    Progress progress;
    const auto done = run_stage(
        "said_vae", parameters(vae), options, checkpoint, [&](std::int64_t step) { return stage.loss(step); },
        progress,
        [&](const StepReport& r) {
          losses.push_back(r.loss);
          rates.push_back(r.learning_rate);
        });
    ASSERT_TRUE(done) << done.error().message();
  }
  said::Vae<torch::Tensor> vae{small_sizes()};
  VaeStage stage{vae, sequences(6), {0, 2, 1, 3}, small_options()};
  std::vector<double> losses, rates;
};

class SaidVaeTraining : public testing::Test {
 protected:
  SaidVaeTraining()
      : checkpoint_(fs::path(testing::TempDir()) /
                    ("said_vae_" + std::to_string(::getpid()) + "_" +
                     testing::UnitTest::GetInstance()->current_test_info()->name() + ".safetensors")) {
    torch::set_num_threads(1);
  }
  ~SaidVaeTraining() override { fs::remove(checkpoint_); }
  fs::path checkpoint_;
};

TEST_F(SaidVaeTraining, LearnsToGiveBackWhatItSees) {
  TrainingRun run;
  const double before = run.stage.reconstruction_error(sequences(6));
  run.train(run.stage.num_steps(), checkpoint_);
  const double after = run.stage.reconstruction_error(sequences(6));
  EXPECT_EQ(run.stage.steps_per_epoch(), 2);
  EXPECT_LT(after, 0.2 * before) << before;
  const double early = std::accumulate(run.losses.begin(), run.losses.begin() + 20, 0.0),
               late = std::accumulate(run.losses.end() - 20, run.losses.end(), 0.0);
  EXPECT_LT(late, 0.3 * early);
}

TEST_F(SaidVaeTraining, WarmsUpFromZero) {
  TrainingRun run;
  run.train(6, checkpoint_, 4);
  EXPECT_EQ(run.rates, (std::vector<double>{0, 5e-3 / 4, 5e-3 / 2, 5e-3 * 3 / 4, 5e-3, 5e-3}));
}

TEST_F(SaidVaeTraining, GoesOnAfterAnInterruptionWithItsStatistics) {
  TrainingRun whole, first, second;
  whole.train(6, checkpoint_);
  fs::remove(checkpoint_);
  first.train(3, checkpoint_);
  second.train(6, checkpoint_);
  first.losses.insert(first.losses.end(), second.losses.begin(), second.losses.end());
  EXPECT_EQ(first.losses, whole.losses);
  const auto a = parameters(whole.vae), b = parameters(second.vae);
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_TRUE(torch::equal(*a[i].slot, *b[i].slot)) << a[i].name;
  EXPECT_GT(second.vae.encoder.conv_norms[0].mean.abs().max().item<double>(), 0) << "statistics have moved";

  TrainingRun snapshot;
  const auto step = load_stage_average(parameters(snapshot.vae), checkpoint_);
  ASSERT_TRUE(step) << step.error().message();
  EXPECT_EQ(*step, 6);
  EXPECT_TRUE(
      torch::equal(snapshot.vae.encoder.conv_norms[0].variance, whole.vae.encoder.conv_norms[0].variance));
}

TEST_F(SaidVaeTraining, AStepDrawsFromItsNumberAlone) {
  TrainingRun a, b;
  const double first = a.stage.loss(4).item<double>();
  (void)b.stage.loss(1);
  TrainingRun c;
  EXPECT_EQ(c.stage.loss(4).item<double>(), first);
  EXPECT_NE(c.stage.loss(5).item<double>(), first);
}

TEST(CyclicalWeights, RiseInEveryCycle) {
  EXPECT_EQ(cyclical_weights(8, 2), (std::vector<double>{0, 0.5, 1, 1, 0, 0.5, 1, 1}));
  EXPECT_EQ(cyclical_weights(1, 1), (std::vector<double>{0}));
  EXPECT_EQ(cyclical_weights(3, 1, 0.5, 0), (std::vector<double>{0, 0, 0}));
  EXPECT_THROW(cyclical_weights(0, 1), std::logic_error);
}

}  // namespace
}  // namespace mien::train
