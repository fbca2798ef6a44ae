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

TEST(MelAugmentation, MasksAFewBandsAndTimes) {
  double masked_bands = 0, masked_frames = 0;
  constexpr int kTrials = 200;
  for (int i = 0; i < kTrials; ++i) {
    std::vector<float> mel(static_cast<std::size_t>(100 * kBands), 0.0f);
    Rng rng(static_cast<std::uint64_t>(i));
    augment_mel(mel, 4, rng);
    const auto is_masked = [&](std::int64_t t, std::int64_t b) {
      return mel[static_cast<std::size_t>(t * kBands + b)] == -8.0f;
    };
    for (std::int64_t b = 0; b < kBands; ++b) masked_bands += is_masked(0, b) && is_masked(99, b);
    for (std::int64_t t = 0; t < 100; ++t)
      masked_frames += is_masked(t, 0) && is_masked(t, kBands / 2) && is_masked(t, kBands - 1);
  }
  EXPECT_NEAR(masked_bands / kTrials, 6.5, 1.5);  // two masks of 0 ... 7 bands, sometimes one over the other
  EXPECT_NEAR(masked_frames / kTrials, 5, 1.5);   // one of 0 ... 10 frames
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
