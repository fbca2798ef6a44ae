#include "mien/train/probtalk3d_training.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <numeric>

#include "mien/train/optimiser.h"
#include "small_encoder_config.h"

namespace mien::train::probtalk3d {
namespace {

namespace fs = std::filesystem;
constexpr std::int64_t kChannels = 8, kStyles = 4;

mien::probtalk3d::Sizes small_sizes(bool is_variational) {
  mien::probtalk3d::Sizes s;
  s.channels = kChannels;
  s.width = 16;
  s.inner = 24;
  s.heads = 2;
  s.prior_blocks = 1;
  s.num_codes = is_variational ? 0 : 12;
  s.code_width = is_variational ? 0 : 8;
  s.predictor_blocks = 1;
  s.condition = 32;
  s.style = kStyles;
  return s;
}

// A tone that comes and goes; the face follows its loudness.
FaceSequence recording(std::size_t index) {
  FaceSequence s;
  s.name = "sequence " + std::to_string(index);
  const auto loud = [&](double t) {
    return 0.5 + 0.5 * std::sin((9 + 2 * static_cast<double>(index % 100)) * t);
  };
  for (int i = 0; i < 12000; ++i) {
    const double t = i / 16000.0;
    s.waveform.push_back(static_cast<float>(1.5 * loud(t) * std::sin(2000 * t)));
  }
  for (int n = 0; n < 19; ++n)
    for (std::int64_t c = 0; c < kChannels; ++c)
      s.motion.push_back(static_cast<float>(0.5 + (c % 2 == 0 ? 0.4 : -0.2) * loud(n / 25.0)));
  s.style = {1, 0, 1, 1};
  return s;
}

FaceSequences recordings(std::size_t num_train) {
  return {num_train, 2, [](FaceSequences::Split split, std::size_t index) -> Result<FaceSequence> {
            return recording(split == FaceSequences::Split::train ? index : index + 100);
          }};
}

StageSettings prior_settings(bool is_variational, double dropout) {
  StageSettings s;
  s.prior = {is_variational ? kGaussianPrior : kQuantisedPrior, flame_jaw(kChannels), kCommitment, dropout};
  return s;
}

PredictorSettings predictor_settings(bool is_random) {
  PredictorSettings s;
  s.jaw = flame_jaw(kChannels);
  s.encoder = {is_random, is_random, is_random};
  if (!is_random) s.dropout = s.prior_dropout = 0;
  return s;
}

std::unique_ptr<TalkingNetwork> small_network(bool is_variational) {
  std::unique_ptr<TalkingNetwork> network(
      new TalkingNetwork{SpeechEncoder<torch::Tensor>(small_encoder_config(1)),
                         mien::probtalk3d::Network<torch::Tensor>(small_sizes(is_variational))});
  initialise_as_published(*network, 3);
  return network;
}

double mean(std::span<const double> x) {
  return std::accumulate(x.begin(), x.end(), 0.0) / static_cast<double>(x.size());
}

class ProbTalk3DTraining : public testing::Test {
 protected:
  void SetUp() override {
    torch::set_num_threads(1);
    folder_ = fs::path(testing::TempDir()) / ("mien_probtalk3d_training_" + std::to_string(getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  // Losses of the steps that were done.
  template <class Stage>
  std::vector<double> run(Stage& stage, const std::vector<Collect::Entry>& learning, std::int64_t num_steps,
                          const std::string& name, std::int64_t stop_after = 0, double rate = 3e-3) {
    std::vector<double> losses;
    Progress progress;
    auto options = StageOptions::plain_adam(num_steps, rate);
    const auto done = run_stage(
        name, learning, options, folder_ / (name + ".safetensors"),
        [&](std::int64_t step) { return stage.loss(step); }, progress,
        [&](const StepReport& r) {
          losses.push_back(r.loss);
          if (r.step + 1 == stop_after) progress.cancel();
        });
    EXPECT_EQ(done.has_value(), stop_after == 0);
    return losses;
  }
  fs::path folder_;
};

TEST_F(ProbTalk3DTraining, BothPriorsLearnASmallSet) {
  for (const bool is_variational : {false, true}) {
    SCOPED_TRACE(is_variational);
    Prior prior(small_sizes(is_variational));
    initialise_as_published(prior, 1);
    PriorStage stage(prior, recordings(3), prior_settings(is_variational, 0));
    const auto before = stage.validate(0);
    ASSERT_TRUE(before) << before.error().message();
    const auto losses = run(stage, parameters(prior), 150, is_variational ? "gaussian" : "codes");
    EXPECT_LT(mean(std::span(losses).last(9)), 0.4 * mean(std::span(losses).first(3)));
    const auto after = stage.validate(0);
    ASSERT_TRUE(after);
    ASSERT_EQ(after->losses.size(), 2u);
    EXPECT_LT(after->mean_loss(), 0.6 * before->mean_loss());
    EXPECT_LT(after->mean_l2, before->mean_l2);
    EXPECT_EQ(after->perplexity == 0, is_variational);
  }
}

TEST_F(ProbTalk3DTraining, ThePredictorLearnsTheLatentOfAFrozenPrior) {
  for (const bool is_variational : {false, true}) {
    SCOPED_TRACE(is_variational);
    const auto network = small_network(is_variational);
    auto& prior = network->network.prior;
    PriorStage first(prior, recordings(3), prior_settings(is_variational, 0));
    run(first, parameters(prior), 120, is_variational ? "prior_gaussian" : "prior_codes");
    const auto kept = prior.decoder.feature_mapping_reverse.detach().clone();
    const auto learning = freeze(parameters(*network), {"motion_prior", "audio_encoder.feature_extractor"});
    ASSERT_TRUE(learning) << learning.error().message();
    PredictorStage stage(*network, recordings(3), predictor_settings(false));
    const auto before = stage.validate(0);
    ASSERT_TRUE(before) << before.error().message();
    const auto losses = run(stage, *learning, 150, is_variational ? "gaussian" : "codes");
    EXPECT_LT(mean(std::span(losses).last(9)), 0.8 * mean(std::span(losses).first(6)));
    EXPECT_LT(stage.validate(0)->mean_loss(), before->mean_loss());
    EXPECT_TRUE(torch::equal(kept, prior.decoder.feature_mapping_reverse)) << "the prior is frozen";
  }
}

TEST_F(ProbTalk3DTraining, AnInterruptedRunGoesOnWithTheSameLosses) {
  for (const bool is_variational : {false, true}) {
    SCOPED_TRACE(is_variational);
    const auto losses = [&](std::int64_t stop_after, const std::string& name) {
      std::vector<double> all;
      for (const std::int64_t stop : {stop_after, std::int64_t{0}}) {
        const auto network = small_network(is_variational);
        const auto learning = freeze(parameters(*network), {"motion_prior"});
        PredictorStage stage(*network, recordings(3), predictor_settings(true));
        const auto part = run(stage, *learning, 14, name, stop);
        all.insert(all.end(), part.begin(), part.end());
        if (stop_after == 0) break;
      }
      return all;
    };
    const std::string name = is_variational ? "gaussian" : "codes";
    const auto whole = losses(0, name + "_whole");
    EXPECT_EQ(whole.size(), 14u);
    EXPECT_EQ(losses(5, name + "_interrupted"), whole);
  }
}

TEST_F(ProbTalk3DTraining, DropoutOfTheFrozenPriorIsAChoice) {
  const auto loss = [&](double prior_dropout, double dropout) {
    const auto network = small_network(false);
    EXPECT_TRUE(freeze(parameters(*network), {"motion_prior"}));
    auto settings = predictor_settings(false);
    settings.prior_dropout = prior_dropout;
    settings.dropout = dropout;
    PredictorStage stage(*network, recordings(1), settings);
    return stage.loss(0)->item<double>();
  };
  EXPECT_EQ(loss(0, 0), loss(0, 0));
  EXPECT_NE(loss(0, 0), loss(0.1, 0));
  EXPECT_NE(loss(0, 0), loss(0, 0.1));
}

TEST_F(ProbTalk3DTraining, AnUndefinedLossEndsAStage) {
  torch::Tensor parameter = torch::ones({1});
  const std::vector<Collect::Entry> entries = {{"parameter", &parameter, true}};
  const auto train = [&](std::int64_t last) {
    Progress progress;
    std::int64_t count = 0;
    const auto done = run_stage(
        "ends", entries, StageOptions::plain_adam(100, 1e-2), folder_ / "ends.safetensors",
        [&](std::int64_t step) -> Result<torch::Tensor> {
          return step == last ? torch::Tensor() : (parameter * parameter).sum();
        },
        progress, [&](const StepReport&) { ++count; });
    EXPECT_TRUE(done);
    return count;
  };
  EXPECT_EQ(train(7), 7);
  const double value = parameter.item<double>();
  parameter = torch::ones({1});
  EXPECT_EQ(train(7), 0) << "its checkpoint is that of its end";
  EXPECT_EQ(parameter.item<double>(), value);
  EXPECT_EQ(train(9), 2);
}

TEST_F(ProbTalk3DTraining, WhatCannotBeLearntFromIsNamed) {
  Prior prior(small_sizes(false));
  initialise_as_published(prior, 1);
  const auto why = [&](const FaceSequence& s) {
    PriorStage stage(prior, {1, 0, [&](FaceSequences::Split, std::size_t) { return Result(s); }},
                     prior_settings(false, 0));
    const auto loss = stage.loss(0);
    return loss ? "" : loss.error().message();
  };
  FaceSequence none = recording(0), one = recording(0), odd = recording(0), longest = recording(0);
  none.motion.clear();
  one.motion.resize(kChannels);
  odd.motion.resize(kChannels * 3 + 1);
  longest.motion.assign(kChannels * 5001, 0.5f);
  EXPECT_NE(why(none).find("no frames"), std::string::npos);
  EXPECT_NE(why(one).find("1 frames"), std::string::npos);
  EXPECT_NE(why(odd).find("no frames"), std::string::npos);
  EXPECT_NE(why(longest).find("5001 frames"), std::string::npos);
  EXPECT_EQ(why(recording(0)), "");
  // Constant motion has no variance that the norm over time could divide by.
  FaceSequence still = recording(0);
  std::ranges::fill(still.motion, 0.5f);
  EXPECT_EQ(why(still), "");
  const auto network = small_network(false);
  ASSERT_TRUE(freeze(parameters(*network), {"motion_prior"}));
  FaceSequence silent = recording(0), brief = recording(0);
  std::ranges::fill(silent.waveform, 0.0f);
  brief.waveform.resize(1200);  // 3 features, 1 frame
  const auto heard = [&](const FaceSequence& s) {
    PredictorStage stage(*network, {1, 0, [&](FaceSequences::Split, std::size_t) { return Result(s); }},
                         predictor_settings(false));
    return stage.loss(0);
  };
  EXPECT_TRUE(std::isfinite(heard(silent)->item<double>()));
  EXPECT_NE(heard(brief).error().message().find("1 frames"), std::string::npos);
}

TEST_F(ProbTalk3DTraining, ArkitsJawIsFourNeighbours) {
  const auto jaw = arkit_jaw();
  const torch::Tensor zero = torch::zeros({1, 3, 52}), moved = zero.clone();
  moved.narrow(-1, jaw.first, jaw.count).fill_(0.5);
  const auto losses = motion_losses(torch::zeros({}), moved, zero, kPredictor, jaw);
  EXPECT_EQ(losses.jaw.item<double>(), 0.5);
  EXPECT_EQ(losses.expression.item<double>(), 0);
  EXPECT_NEAR(losses.total.item<double>(), 0.05, 1e-7);
}

}  // namespace
}  // namespace mien::train::probtalk3d
