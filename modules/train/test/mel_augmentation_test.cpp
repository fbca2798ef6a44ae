#include "../src/mel_augmentation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "mien/audio/log_mel.h"

namespace mien::train {
namespace {

constexpr std::int64_t kBands = kNumMelBands;

// Loud for 50 frames, then quiet.
std::vector<float> burst(std::int64_t frames) {
  std::vector<float> mel(static_cast<std::size_t>(frames * kBands), -14.0f);
  std::fill_n(mel.begin(), 50 * kBands, 0.0f);
  return mel;
}

double mean_of_frame(const std::vector<float>& mel, std::int64_t t) {
  double sum = 0;
  for (std::int64_t b = 0; b < kBands; ++b) sum += mel[static_cast<std::size_t>(t * kBands + b)];
  return sum / kBands;
}

TEST(MelAugmentation, ReverberationRingsOnAndFallsBySixtyDecibelsInItsTime) {
  auto mel = burst(200);
  add_reverberation(mel, 0.5, 0.25);
  EXPECT_NEAR(mean_of_frame(mel, 40), std::log(1.25), 0.02) << "direct sound and a full tail";
  EXPECT_NEAR(mean_of_frame(mel, 50), std::log(0.25), 0.05) << "the tail alone";
  EXPECT_NEAR(mean_of_frame(mel, 50) - mean_of_frame(mel, 70), 0.4 * 60 * std::log(10.0) / 10, 0.1);
}

TEST(MelAugmentation, NoiseFillsTheQuietAndLeavesTheLoud) {
  double quiet = 0, loud = 0;
  constexpr int kTrials = 200;
  for (int i = 0; i < kTrials; ++i) {
    auto mel = burst(100);
    Rng rng(static_cast<std::uint64_t>(i));
    add_noise(mel, 20, rng);
    quiet += mean_of_frame(mel, 80) / kTrials;
    loud += mean_of_frame(mel, 20) / kTrials;
  }
  EXPECT_NEAR(quiet, -24 * std::log(10.0) / 10, 0.6);
  EXPECT_NEAR(loud, 0, 0.03);
}

TEST(MelAugmentation, NoiseInWeakBandsLeavesTheLevelWhereItWas) {
  // Speech: strong low bands, upper ones 30 dB weaker. White noise 10 dB below covers the upper ones.
  double after = 0, contrast = 0, before = 0;
  constexpr int kTrials = 40;
  for (int i = 0; i < kTrials; ++i) {
    std::vector<float> mel(static_cast<std::size_t>(100 * kBands));
    for (std::size_t j = 0; j < mel.size(); ++j) mel[j] = j % kBands < 16 ? 4.0f : -2.9f;
    before = mean_of_frame(mel, 50);
    Rng rng(static_cast<std::uint64_t>(i));
    add_noise(mel, 10, rng);
    for (std::int64_t t = 0; t < 100; ++t) after += mean_of_frame(mel, t) / 100 / kTrials;
    for (std::size_t t = 0; t < 100; ++t)
      contrast += (mel[t * kBands + 5] - mel[t * kBands + 40]) / 100 / kTrials;
  }
  EXPECT_NEAR(after, before, 1.0) << "loud frames are where they were, others a little lower";
  EXPECT_LT(contrast, 5.0) << "6.9 without the noise";
  EXPECT_GT(contrast, 3.0);
}

TEST(MelAugmentation, IsTheSameForASeedAndAlwaysFinite) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    auto a = burst(120), b = a;
    Rng first(seed), second(seed);
    augment_mel(a, 4, first);
    augment_mel(b, 4, second);
    ASSERT_EQ(a, b);
    for (const float v : a) ASSERT_TRUE(std::isfinite(v) && v > -40 && v < 20) << v;
  }
}

TEST(MelAugmentation, OneFrameAndNone) {
  for (const std::size_t frames : {0u, 1u}) {
    std::vector<float> mel(frames * kBands, -14.0f);
    Rng rng(3);
    augment_mel(mel, 4, rng);
    for (const float v : mel) EXPECT_TRUE(std::isfinite(v));
  }
}

}  // namespace
}  // namespace mien::train
