#include "mien/train/encoder_randomness.h"

#include <gtest/gtest.h>

#include <numeric>

namespace mien::train {
namespace {

std::int64_t count(const std::vector<std::uint8_t>& flags) {
  return std::accumulate(flags.begin(), flags.end(), std::int64_t{0});
}

// Lengths of the runs of masked frames.
std::vector<std::int64_t> runs(const std::vector<std::uint8_t>& flags) {
  std::vector<std::int64_t> lengths;
  for (std::size_t i = 0; i < flags.size(); ++i) {
    if (flags[i] == 0) continue;
    if (i == 0 || flags[i - 1] == 0) lengths.push_back(0);
    ++lengths.back();
  }
  return lengths;
}

TEST(SpecAugment, MasksTheExpectedShareInWholeSpans) {
  const EncoderConfig config;
  Rng rng(5);
  constexpr std::int64_t kFrames = 1000, kDraws = 2000;
  double sum = 0;
  for (std::int64_t i = 0; i < kDraws; ++i) {
    const auto masked = draw_masked_frames(config, kFrames, rng);
    ASSERT_EQ(masked.size(), static_cast<std::size_t>(kFrames));
    for (const std::int64_t length : runs(masked)) EXPECT_GE(length, config.mask_time_length);
    sum += static_cast<double>(count(masked));
  }
  // 5 spans of 10 frames, less the expected overlap of their 10 pairs: 2 (9 + ... + 1) / 991 frames each.
  EXPECT_NEAR(sum / kDraws, 49.09, 0.25);
}

TEST(SpecAugment, RoundsTheNumberOfSpansAtRandom) {
  EncoderConfig config;
  config.mask_time_length = 1;  // a span is a frame, and starts are distinct
  config.mask_time_min_masks = 0;
  Rng rng(6);
  double sum = 0;
  for (int i = 0; i < 4000; ++i) {
    const std::int64_t n = count(draw_masked_frames(config, 25, rng));
    EXPECT_TRUE(n == 1 || n == 2) << n;  // 0.05 * 25 = 1.25
    sum += static_cast<double>(n);
  }
  EXPECT_NEAR(sum / 4000, 1.25, 0.03);
}

TEST(SpecAugment, StartsAreUniformOverAllPlaces) {
  EncoderConfig config;
  config.mask_time_min_masks = 1;
  config.mask_time_prob = 1e-6;  // one span
  Rng rng(7);
  std::vector<int> starts(13, 0);  // of 22 frames: 0 ... 12
  for (int i = 0; i < 13000; ++i) {
    const auto masked = draw_masked_frames(config, 22, rng);
    const auto first = std::find(masked.begin(), masked.end(), std::uint8_t{1}) - masked.begin();
    ASSERT_LT(first, 13);
    ++starts[static_cast<std::size_t>(first)];
  }
  for (const int n : starts) EXPECT_NEAR(n, 1000, 150);  // 4.9 standard deviations
}

TEST(SpecAugment, TakesFewerSpansWhenTheyWouldNotFitAndNoneInLessThanOne) {
  const EncoderConfig config;
  Rng rng(8);
  for (int i = 0; i < 50; ++i) {
    EXPECT_EQ(count(draw_masked_frames(config, 19, rng)), 10);  // two spans would need 20 frames
    EXPECT_EQ(count(draw_masked_frames(config, 10, rng)), 10);
  }
  EXPECT_TRUE(draw_masked_frames(config, 9, rng).empty());
  EXPECT_TRUE(draw_masked_frames(config, 0, rng).empty());
  EncoderConfig off;
  off.apply_spec_augment = false;
  EXPECT_TRUE(draw_masked_frames(off, 100, rng).empty());
}

TEST(LayerDrop, LeavesOutEveryLayerAlike) {
  const EncoderConfig config;
  Rng rng(9);
  std::vector<int> skipped(12, 0);
  for (int i = 0; i < 10000; ++i) {
    const auto flags = draw_skipped_layers(config, rng);
    ASSERT_EQ(flags.size(), skipped.size());
    for (std::size_t k = 0; k < flags.size(); ++k) skipped[k] += flags[k];
  }
  for (const int n : skipped) EXPECT_NEAR(n, 1000, 150);  // 5 standard deviations
  EncoderConfig off;
  off.layerdrop = 0;
  EXPECT_TRUE(draw_skipped_layers(off, rng).empty());
}

}  // namespace
}  // namespace mien::train
