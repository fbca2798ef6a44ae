#include "mien/metrics/coefficient_comparison.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mien/base/random.h"
#include "mien/metrics/speech_onsets.h"

namespace mien {
namespace {

constexpr std::int64_t kWindow = 4;

// One channel; the feature of a window is its first value and its number.
Motion ramp(int num_frames, float start) {
  Motion m{MotionSpace::arkit, {"jawOpen"}, 60, {}};
  for (int n = 0; n < num_frames; ++n) m.values.push_back(start + static_cast<float>(n * n));
  return m;
}

FeatureTable first_values(const Motion& motion, std::int64_t num_windows) {
  FeatureTable table{2, {}};
  for (std::int64_t w = 0; w < num_windows; ++w)
    table.values.insert(table.values.end(),
                        {static_cast<double>(motion.frame(w)[0]), static_cast<double>(w)});
  return table;
}

TEST(CoefficientComparison, KeepsTheWindowsThatBothHave) {
  CoefficientComparison comparison(kWindow, first_values);
  comparison.add_truth("A", 1, ramp(10, 0));                   // 7 windows, less 2
  comparison.add_truth("A", 2, ramp(5, 0));                    // 2 windows, less 2
  EXPECT_TRUE(comparison.add_generated("A", 1, ramp(12, 3)));  // 9 windows, of which 5 count
  EXPECT_TRUE(comparison.add_generated("A", 1, ramp(7, 6)));   // 4
  EXPECT_TRUE(comparison.add_generated("A", 2, ramp(10, 0)));  // none
  EXPECT_FALSE(comparison.add_generated("B", 1, ramp(10, 0)));
  EXPECT_FALSE(comparison.add_generated("A", 3, ramp(10, 0)));
  const MotionDistances d = comparison.distances({.mixture = {.num_components = 1}, .num_repeats = 2});
  EXPECT_EQ(d.num_true, 5);
  EXPECT_EQ(d.num_generated, 9);
  EXPECT_EQ(d.num_pairs, 4);
  EXPECT_NEAR(d.multimodality, 3, 1e-12);
  EXPECT_GT(d.fd, 0);
  EXPECT_NEAR(d.wind.deviation, 0, 1e-9) << "one component has one fit";
}

TEST(CoefficientComparison, OfASequenceWithItselfIsZero) {
  CoefficientComparison comparison(kWindow, first_values);
  comparison.add_truth("A", 1, ramp(40, 0));
  EXPECT_TRUE(comparison.add_generated("A", 1, ramp(40, 0)));
  const MotionDistances d = comparison.distances({.mixture = {.num_components = 1}, .num_repeats = 1});
  EXPECT_NEAR(d.fd, 0, 1e-6);
  EXPECT_TRUE(std::isnan(d.multimodality)) << "one repetition";
}

TEST(CoefficientComparison, WithoutWindowsIsNotDefined) {
  CoefficientComparison comparison(kWindow, first_values);
  comparison.add_truth("A", 1, ramp(3, 0));
  EXPECT_TRUE(comparison.add_generated("A", 1, ramp(0, 0)));
  const MotionDistances d = comparison.distances({});
  EXPECT_EQ(d.num_generated, 0);
  EXPECT_TRUE(std::isnan(d.fd) && std::isnan(d.wind.mean) && std::isnan(d.multimodality));
}

TEST(SpeechOnsets, LieWhereBurstsBegin) {
  std::vector<float> samples(16000 * 3), noise(samples.size());
  NoiseField(2, 0).normal(0, 0, noise);
  const std::vector<double> starts = {0.5, 1.2, 2.1};
  for (const double start : starts)
    for (std::size_t i = 0; i < 3200; ++i) {
      const auto at = static_cast<std::size_t>(start * 16000) + i;
      samples[at] = 0.3f * noise[at];
    }
  const auto onsets = speech_onsets(samples);
  for (const double start : starts) {
    double nearest = 1;
    for (const double onset : onsets) nearest = std::min(nearest, std::abs(onset - start));
    EXPECT_LT(nearest, 0.08) << start;
  }
  for (const double onset : onsets) {
    double nearest = 1;
    for (const double start : starts) nearest = std::min(nearest, std::abs(onset - start));
    EXPECT_LT(nearest, 0.12) << onset;
  }
}

TEST(SpeechOnsets, OfSilenceAndOfNothingAreNone) {
  EXPECT_TRUE(speech_onsets(std::vector<float>(16000, 0.0f)).empty());
  EXPECT_TRUE(speech_onsets({}).empty());
  EXPECT_TRUE(speech_onsets(std::vector<float>{0.5f}).empty());
}

}  // namespace
}  // namespace mien
