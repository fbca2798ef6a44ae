// ProbTalk3D's codes, its takes, and the whole of it on a small model with random weights.
#include "mien/models/probtalk3d/takes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>

#include "mien/models/face_model.h"
#include "mien/models/probtalk3d/codes.h"
#include "mien/models/probtalk3d/conventions.h"
#include "mien/models/probtalk3d/validation.h"
#include "mien/models/seeds.h"
#include "random_network.h"
#include "small_face_model.h"

namespace mien {
namespace {

using probtalk3d::DrawOptions;
using probtalk3d::Takes;
using testing::HasSubstr;

TEST(Codes, TheFirstOfEqualDistancesIsNearest) {
  EXPECT_EQ(probtalk3d::nearest_codes(std::vector<float>{3, 1, 1, 5, 5, 4}, 3),
            (std::vector<std::int64_t>{1, 2}));
}

TEST(Codes, ProbabilitiesSumToOneAtAnyTemperature) {
  const std::vector<float> distances = {0, 1, 2, 1000, 1001, 2000};
  for (const double temperature : {1e-3, 0.2, 1.0, 1e6}) {
    const auto p = probtalk3d::code_probabilities(distances, 3, temperature);
    for (std::size_t row = 0; row < 6; row += 3) {
      EXPECT_NEAR(p[row] + p[row + 1] + p[row + 2], 1, 1e-6);
      EXPECT_GE(p[row], p[row + 1]);
    }
    EXPECT_NEAR(p[1] / p[0], std::exp(-1 / temperature), 1e-6);
  }
}

// The race gives each code as often as its probability says, and places without replacement.
TEST(Codes, RacesAreDraws) {
  const std::vector<float> p = {0.5f, 0.3f, 0.2f, 0.0f};
  constexpr int kDraws = 20000;
  std::vector<float> many;
  for (int i = 0; i < kDraws; ++i) many.insert(many.end(), p.begin(), p.end());
  const NoiseField noise(5, 0);
  const probtalk3d::CodeRace race = [&](std::int64_t chunk, std::span<float> out) {
    for (std::size_t j = 0; j < out.size(); ++j)
      out[j] = static_cast<float>(
          -std::log1p(-noise.uniform(static_cast<std::uint64_t>(chunk) * out.size() + j, 0)));
  };
  std::vector<std::vector<std::int64_t>> places;
  for (const int place : {1, 2, 3, 4}) places.push_back(probtalk3d::draw_codes(many, 4, place, race));
  std::vector<double> share(4);
  for (const auto code : places[0]) share[static_cast<std::size_t>(code)] += 1.0 / kDraws;
  for (std::size_t j = 0; j < 4; ++j) EXPECT_NEAR(share[j], p[j], 0.015) << j;
  for (std::size_t n = 0; n < kDraws; ++n) {
    EXPECT_NE(places[0][n], places[1][n]);
    EXPECT_NE(places[1][n], places[2][n]);
    EXPECT_EQ(places[3][n], places[2][n]) << "the fourth has no probability: the last that has";
  }
}

TEST(Validation, PerplexityCountsTheCodesInUse) {
  using Codes = std::vector<std::int64_t>;
  EXPECT_NEAR(probtalk3d::code_perplexity(Codes{3, 3, 3}, 8), 1, 1e-8);
  EXPECT_NEAR(probtalk3d::code_perplexity(Codes{0, 1, 2, 3}, 8), 4, 1e-7);
  EXPECT_TRUE(std::isnan(probtalk3d::code_perplexity(Codes{}, 8)));
  EXPECT_THROW((void)probtalk3d::code_perplexity(Codes{8}, 8), std::logic_error);
}

TEST(Validation, DistanceOfMotions) {
  const Tensor truth({2, 2}, std::vector<float>{0, 0, 2, 0}), far({2, 2}, std::vector<float>{3, 4, 5, 4});
  const auto moved = probtalk3d::motion_distance(far, truth);
  EXPECT_NEAR(moved.mean_l2, 5, 1e-12);
  EXPECT_NEAR(moved.mean_var, 0, 1e-12) << "moved as a whole, it varies alike";
  EXPECT_NEAR(probtalk3d::motion_distance(Tensor({2, 2}), truth).mean_var, 2, 1e-12);
  EXPECT_TRUE(std::isnan(probtalk3d::motion_distance(Tensor({0, 2}), Tensor({0, 2})).mean_l2));
  EXPECT_THROW((void)probtalk3d::motion_distance(Tensor({1, 2}), truth), std::logic_error);
}

probtalk3d::Sizes small_sizes(bool variational) {
  probtalk3d::Sizes s;
  s.channels = 9;
  s.width = 8;
  s.inner = 12;
  s.heads = 2;
  s.prior_blocks = 1;
  s.num_codes = variational ? 0 : 16;
  s.code_width = variational ? 0 : 4;
  s.predictor_blocks = 2;
  s.condition = 32;
  s.style = 2 + 8 + 3;
  return s;
}

TEST(Takes, DependOnTheirSeedAlone) {
  for (const bool variational : {false, true}) {
    const auto network = random_network(probtalk3d::Network<Tensor>(small_sizes(variational)));
    const Takes takes(network, random_rows(7, 8, 1), {.temperature = 5, .noise_factor = 3});
    const Tensor first = takes.take(1), second = takes.take(2);
    EXPECT_EQ(first.shape(), (Shape{7, 9}));
    EXPECT_TRUE(std::ranges::equal(first.values(), takes.take(1).values()));
    EXPECT_FALSE(std::ranges::equal(first.values(), second.values()));
  }
}

TEST(Takes, WithoutChanceAreTheNearestCodesOrTheMean) {
  const auto network = random_network(probtalk3d::Network<Tensor>(small_sizes(false)));
  const Tensor z = random_rows(6, 8, 3);
  const Takes still(network, z, {.temperature = 0});
  EXPECT_EQ(still.codes(1), still.codes(2));
  const Takes cold(network, z, {.temperature = 1e-6});
  EXPECT_EQ(cold.codes(9), still.codes(1)) << "no temperature is the limit of a low one";
  const auto gaussian = random_network(probtalk3d::Network<Tensor>(small_sizes(true)));
  const Takes mean(gaussian, z, {.noise_factor = 0});
  EXPECT_TRUE(std::ranges::equal(mean.take(1).values(), mean.take(2).values()));
  EXPECT_TRUE(mean.codes(1).empty());
}

// z is cut channel by channel: a code stands for numbers that follow each other in time.
TEST(Quantiser, CutsChannelsIntoRuns) {
  probtalk3d::Quantiser<Tensor> quantiser{2, 2, 3, Tensor({2, 2}, std::vector<float>{0, 0, 9, 9})};
  const Tensor z({4, 3}, std::vector<float>{0, 10, 20, 1, 11, 21, 2, 12, 22, 3, 13, 23});
  const Tensor chunks = quantiser.chunks(z);
  EXPECT_THAT(chunks.values(), testing::ElementsAre(0, 1, 2, 3, 10, 11, 12, 13, 20, 21, 22, 23));
  EXPECT_EQ(chunks.shape(), (Shape{6, 2}));
  const Tensor back = quantiser.latent(std::vector<std::int64_t>{0, 1, 0, 0, 1, 1}, 4);
  EXPECT_THAT(back.values(), testing::ElementsAre(0, 0, 9, 0, 0, 9, 9, 0, 9, 9, 0, 9));
  EXPECT_TRUE(quantiser.fits(4));
  EXPECT_FALSE(quantiser.fits(3)) << "nine numbers are not whole codes of two";
}

std::filesystem::path write_small(bool variational) {
  ModelFile m;
  m.architecture = Architecture::probtalk3d;
  m.name = "small";
  m.encoder = small_face_encoder();
  const auto sizes = small_sizes(variational);
  m.output = {.space = "flame", .channels = sizes.channels, .fps = 25, .topology = "flame"};
  m.scaler = probtalk3d::published_scaler(sizes.channels);
  m.sizes["heads"] = sizes.heads;
  m.subjects = {"M003", "W028"};
  m.emotions = probtalk3d::published_emotions();
  m.intensities = probtalk3d::published_intensities();
  const auto path = std::filesystem::path(testing::TempDir()) /
                    ("mien_probtalk3d_" + std::to_string(getpid()) + ".safetensors");
  write_face_model(path, m, probtalk3d::Network<Tensor>(sizes));
  return path;
}

AudioClip noise_clip(double seconds) {
  AudioClip clip;
  clip.samples.resize(static_cast<std::size_t>(seconds * 16000));
  NoiseField(1, 1).normal(0, 0, clip.samples);
  return clip;
}

TEST(ProbTalk3DModel, AnimatesFlameParameters) {
  for (const bool variational : {false, true}) {
    const auto model = FaceModel::load(write_small(variational));
    ASSERT_TRUE(model) << model.error().message();
    Progress progress;
    FaceOptions options;
    options.style = "W028";
    options.emotion = "happy:3";
    options.draw.temperature = 5;
    options.seed = 3;
    const auto takes = animate(*model, noise_clip(1.2), options, 5, 3, progress);
    ASSERT_TRUE(takes) << takes.error().message();
    const Motion& first = takes->front();
    EXPECT_EQ(first.space, MotionSpace::flame);
    EXPECT_EQ(first.fps, 25);
    EXPECT_EQ(first.channels.front(), "expression_0");
    EXPECT_EQ(first.channels.back(), "jaw_z");
    EXPECT_EQ(first.num_frames(), small_face_encoder().num_frames(19200) / 2);
    EXPECT_NE(first.values, takes->at(1).values);
    for (const int threads : {1, 2, 7}) {
      const auto again = animate(*model, noise_clip(1.2), options, 5, threads, progress);
      for (std::size_t k = 0; k < 5; ++k) EXPECT_EQ(again->at(k).values, takes->at(k).values) << threads;
    }
    FaceOptions other = options;
    other.emotion = "happy:low";
    EXPECT_NE(animate(*model, noise_clip(1.2), other, 1, 1, progress)->front().values, first.values);
    other = options;
    other.style = "M003";
    EXPECT_NE(animate(*model, noise_clip(1.2), other, 1, 1, progress)->front().values, first.values);
    other = {};
    FaceOptions neutral;
    neutral.emotion = "neutral:1";
    neutral.style = "M003";
    EXPECT_EQ(animate(*model, noise_clip(1.2), other, 1, 1, progress)->front().values,
              animate(*model, noise_clip(1.2), neutral, 1, 1, progress)->front().values)
        << "the default is the first identity, neutral";
  }
}

TEST(ProbTalk3DModel, SilenceAndShortAndLongClips) {
  const auto model = FaceModel::load(write_small(false));
  ASSERT_TRUE(model) << model.error().message();
  Progress progress;
  AudioClip silence;
  silence.samples.resize(16000);
  const auto still = animate(*model, silence, {}, 1, 1, progress);
  ASSERT_TRUE(still) << still.error().message();
  for (const float v : still->front().values) ASSERT_TRUE(std::isfinite(v));
  for (const std::size_t count : {0u, 1u, 400u, 1359u}) {
    AudioClip clip;
    clip.samples.resize(count);
    EXPECT_EQ(animate(*model, clip, {}, 1, 1, progress).error().code, Errc::input) << count;
  }
  AudioClip shortest = noise_clip(1);
  shortest.samples.resize(1360);
  EXPECT_EQ(animate(*model, shortest, {}, 1, 1, progress)->front().num_frames(), 2);
  AudioClip broken = noise_clip(1);
  broken.samples[77] = NAN;
  EXPECT_EQ(animate(*model, broken, {}, 1, 1, progress).error().code, Errc::input);
  AudioClip long_clip = noise_clip(201);
  EXPECT_THAT(animate(*model, long_clip, {}, 1, 1, progress).error().message(), HasSubstr("5000"));
  progress.cancel();
  EXPECT_EQ(animate(*model, noise_clip(1), {}, 1, 1, progress).error().code, Errc::cancelled);
}

TEST(ProbTalk3DModel, RefusesWordsThatItDoesNotKnow) {
  const auto model = FaceModel::load(write_small(false));
  ASSERT_TRUE(model) << model.error().message();
  Progress progress;
  const auto refusal = [&](const FaceOptions& options) {
    const auto takes = animate(*model, noise_clip(1), options, 1, 1, progress);
    EXPECT_FALSE(takes);
    if (takes) return std::string();
    EXPECT_EQ(takes.error().code, Errc::usage);
    return takes.error().message();
  };
  FaceOptions style, emotion, level, word, empty, place, cold;
  style.style = "W999";
  emotion.emotion = "gleeful:2";
  level.emotion = "happy:4";
  word.emotion = "happy:huge";
  empty.emotion = "happy:";
  place.draw.place = 17;
  cold.draw.temperature = -1;
  EXPECT_THAT(refusal(style), HasSubstr("It knows: M003, W028"));
  EXPECT_THAT(refusal(emotion), HasSubstr("surprised"));
  EXPECT_THAT(refusal(level), HasSubstr("1 to 3"));
  EXPECT_THAT(refusal(word), HasSubstr("low, medium, high"));
  EXPECT_THAT(refusal(empty), HasSubstr("intensity"));
  EXPECT_THAT(refusal(place), HasSubstr("16 codes"));
  EXPECT_THAT(refusal(cold), HasSubstr("--temperature"));
}

}  // namespace
}  // namespace mien
