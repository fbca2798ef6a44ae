#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numeric>

#include "../src/raise_target.h"
#include "mien/base/hash.h"
#include "mien/train/default_model.h"
#include "small_set.h"

namespace mien::train {
namespace {

namespace fs = std::filesystem;
namespace dm = default_model;

class DefaultTraining : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) /
              ("mien_train_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    torch::set_num_threads(1);
    auto set = TrainingSet::open(write_small_set(folder_ / "set.safetensors"));
    ASSERT_TRUE(set) << set.error().message();
    set_ = std::make_unique<TrainingSet>(std::move(*set));
    options_.mean_batch = 4;
    options_.crop_frames = 60;
    options_.sequence_batch = 4;
    options_.sequence_chunks = 20;
  }
  void TearDown() override { fs::remove_all(folder_); }

  Network fresh_network() const {
    Network network(dm::Sizes{16, 8, 24, 16, 16});
    Initialise initialise(3);
    network.visit(initialise);
    measure_face_statistics(*set_, network);
    return network;
  }
  // Losses of a stage, run up to `stop_after` steps at first when that is not 0, then to the end.
  template <class Stage>
  std::vector<double> losses(Stage& stage, std::int64_t num_steps, std::int64_t stop_after,
                             const std::string& name) {
    StageOptions options;
    options.num_steps = num_steps;
    options.warm_up_steps = 5;
    options.learning_rate = 5e-3;
    std::vector<double> out;
    for (const bool first : {true, false}) {
      if (first && stop_after == 0) continue;
      Progress progress;
      const auto done = run_stage(
          name, stage.parameters(), options, folder_ / (name + ".safetensors"),
          [&](std::int64_t step) { return stage.loss(step); }, progress,
          [&](const StepReport& r) {
            out.push_back(r.loss);
            if (first && r.step + 1 == stop_after) progress.cancel();
          });
      EXPECT_EQ(done.has_value(), !first);
    }
    return out;
  }

  fs::path folder_;
  std::unique_ptr<TrainingSet> set_;
  DefaultTrainingOptions options_;
};

TEST_F(DefaultTraining, MeanPathLearnsTheJaw) {
  Network network = fresh_network();
  MeanStage stage(*set_, network, options_);
  const auto l = losses(stage, 60, 0, "mean");
  EXPECT_LT(l.back(), 0.6 * l.front());
  EXPECT_TRUE(std::isfinite(stage.validation_loss(1)));
}

TEST_F(DefaultTraining, GoesOnAfterAnInterruptionWithTheSameLosses) {
  Network whole = fresh_network(), resumed = fresh_network();
  MeanStage a(*set_, whole, options_);
  const auto want = losses(a, 12, 0, "whole");
  MeanStage b(*set_, resumed, options_);
  const auto got = losses(b, 12, 5, "resumed");
  EXPECT_EQ(got, want);
}

TEST_F(DefaultTraining, DiffusionAndEventPathsLearn) {
  Network network = fresh_network();
  Progress progress;
  const auto path = folder_ / "features.safetensors";
  MeanStage mean(*set_, network, options_);  // its first frame is the past of a first chunk
  losses(mean, 100, 0, "mean");
  ASSERT_TRUE(write_chunk_features(*set_, network, options_, path, progress));
  const auto features = ChunkFeatures::open(path);
  ASSERT_TRUE(features);
  EXPECT_EQ(features->speech.size(0), 4 * 30);
  measure_coefficient_sd(*set_, *features, network, options_);
  DiffusionStage diffusion(*set_, *features, network, options_);
  const auto l = losses(diffusion, 100, 0, "diffusion");
  // Steps differ in their noise levels: compare averages.
  EXPECT_LT(std::accumulate(l.end() - 20, l.end(), 0.0),
            0.6 * std::accumulate(l.begin(), l.begin() + 20, 0.0));
  EventStage blink(*set_, *features, network, options_, EventStage::Events::blinks);
  const auto b = losses(blink, 60, 0, "blink");
  EXPECT_LT(b.back(), 0.3 * b.front());  // they come every tenth chunk: fully predictable
  EventStage brow(*set_, *features, network, options_, EventStage::Events::brow_raises);
  const auto r = losses(brow, 120, 0, "brow");
  EXPECT_LT(r.back(), 0.3 * r.front());  // every 90 frames, always 64 / 255
}

TEST_F(DefaultTraining, RaisesBeginAtTheirAccentOrNearTheirCentre) {
  for (const std::size_t entry : {0u, 3u}) {
    const std::int64_t onset = entry == 0 ? 33 : 31;
    for (std::int64_t n = -5; n < 365; ++n) {
      const bool begins = n >= 0 && n < 360 && n % 90 == onset;
      EXPECT_FLOAT_EQ(raise_that_begins(*set_, 1, set_->entries()[entry], n), begins ? 64.0f / 255 : 0)
          << "entry " << entry << " frame " << n;
    }
  }
}

TEST_F(DefaultTraining, SavedParametersLoadAgainAndRefuseOtherSizes) {
  Network network = fresh_network();
  ASSERT_TRUE(save_parameters(parameters(network), folder_ / "model.safetensors", false, {}));
  const auto file = SafetensorsFile::open(folder_ / "model.safetensors");
  ASSERT_TRUE(file);
  Network other = fresh_network();
  const torch::NoGradGuard no_grad;
  other.mean.out.bias.add_(1);
  ASSERT_TRUE(load_parameters(parameters(other), *file));
  EXPECT_TRUE(torch::equal(other.mean.out.bias, network.mean.out.bias));
  Network larger(dm::Sizes{24, 8, 24, 16, 16});
  Initialise initialise(3);
  larger.visit(initialise);
  EXPECT_EQ(load_parameters(parameters(larger), *file).error().code, Errc::incompatible);
}

TEST_F(DefaultTraining, AveragesNothingWhenTheLossIsNotFinite) {
  Network network = fresh_network();
  MeanStage stage(*set_, network, options_);
  Progress progress;
  const auto done = run_stage(
      "mean", stage.parameters(), {}, folder_ / "x.safetensors",
      [&](std::int64_t step) { return stage.loss(step) * std::nan(""); }, progress, [](const StepReport&) {});
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, Errc::failed);
}

}  // namespace
}  // namespace mien::train
