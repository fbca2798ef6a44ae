#include "mien/metrics/statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "mien/metrics/bootstrap.h"

namespace mien {
namespace {

TEST(Statistics, PercentilesInterpolateBetweenOrderStatistics) {
  EXPECT_DOUBLE_EQ(percentile({4, 1, 3, 2}, 90), 3.7);
  EXPECT_DOUBLE_EQ(percentile({4, 1, 3, 2}, 0), 1);
  EXPECT_DOUBLE_EQ(percentile({4, 1, 3, 2}, 100), 4);
  EXPECT_DOUBLE_EQ(median({5}), 5);
  EXPECT_DOUBLE_EQ(median_absolute_deviation({1, 2, 3, 4, 100}), 1);
  EXPECT_TRUE(std::isnan(median({})));
  EXPECT_TRUE(std::isnan(mean({})));
  EXPECT_THROW((void)percentile({1}, 101), std::logic_error);
}

TEST(Statistics, PearsonIsExactOnLinesAndUndefinedOnConstants) {
  const std::vector<double> x = {1, 2, 3, 4}, up = {3, 5, 7, 9}, down = {4, 3, 2, 1}, flat(4, 0.1),
                            hill = {0, 1, 1, 0};
  EXPECT_DOUBLE_EQ(pearson(x, up), 1);
  EXPECT_DOUBLE_EQ(pearson(x, down), -1);
  EXPECT_NEAR(pearson(x, hill), 0, 1e-15);
  EXPECT_TRUE(std::isnan(pearson(x, flat)));
  EXPECT_TRUE(std::isnan(pearson({}, {})));
  EXPECT_NEAR(pearson(std::vector<double>{1, 2, 4}, std::vector<double>{1, 3, 4}), 0.9285714285714285, 1e-12);
}

TEST(Statistics, FisherMeanWeighsAndSkipsWhatIsUndefined) {
  const std::vector<double> r = {0.5, std::nan(""), 0.9}, w = {1, 5, 1};
  EXPECT_NEAR(fisher_mean(r, w), std::tanh((std::atanh(0.5) + std::atanh(0.9)) / 2), 1e-12);
  EXPECT_NEAR(fisher_mean(std::vector<double>{0.7}, std::vector<double>{3}), 0.7, 1e-12);
  EXPECT_TRUE(std::isnan(fisher_mean(std::vector<double>{0.7}, std::vector<double>{0})));
}

TEST(Statistics, KsDistanceOfKnownSamples) {
  EXPECT_DOUBLE_EQ(ks_distance({1, 2, 3}, {3, 2, 1}), 0);
  EXPECT_DOUBLE_EQ(ks_distance({1, 2}, {3, 4}), 1);
  EXPECT_DOUBLE_EQ(ks_distance({1, 2, 3, 4}, {3, 4, 5, 6}), 0.5);
  EXPECT_DOUBLE_EQ(ks_distance({1, 1, 1, 2}, {1, 2, 2, 2}), 0.5);
  EXPECT_TRUE(std::isnan(ks_distance({}, {1})));
}

TEST(Statistics, SmoothingKeepsConstantsAndSumsInside) {
  for (const double v : smooth_gaussian(std::vector<double>(5, 2.5), 1.8, 6)) EXPECT_NEAR(v, 2.5, 1e-12);
  std::vector<double> impulse(31, 0.0);
  impulse[15] = 1;
  const auto s = smooth_gaussian(impulse, 1.8, 6);
  double sum = 0;
  for (const double v : s) sum += v;
  EXPECT_NEAR(sum, 1, 1e-12);
  EXPECT_DOUBLE_EQ(s[14], s[16]);
  EXPECT_NEAR(s[16] / s[15], std::exp(-0.5 / (1.8 * 1.8)), 1e-12);
  EXPECT_EQ(s[8], 0);
}

TEST(Bootstrap, DrawsWholeSpeakersReproducibly) {
  const std::vector<std::string> speakers = {"a", "b", "a", "c"};
  const auto draws = speaker_draws(speakers, 200, 7);
  EXPECT_EQ(draws, speaker_draws(speakers, 200, 7));
  EXPECT_NE(draws, speaker_draws(speakers, 200, 8));
  bool without_b = false;
  for (const auto& draw : draws) {
    ASSERT_GE(draw.size(), 3u);
    ASSERT_LE(draw.size(), 6u);  // three speakers, at most two clips each
    bool b = false;
    for (const auto i : draw) b |= i == 1;
    without_b |= !b;
  }
  EXPECT_TRUE(without_b);
  EXPECT_TRUE(speaker_draws({}, 3, 1)[0].empty());
}

TEST(Bootstrap, IntervalsHoldTheMiddle95PercentAndSkipNan) {
  std::vector<double> values = {std::nan("")};
  for (int i = 0; i <= 1000; ++i) values.push_back(i);
  const Interval interval = interval_of(values);
  EXPECT_DOUBLE_EQ(interval.low, 25);
  EXPECT_DOUBLE_EQ(interval.high, 975);
  EXPECT_TRUE(std::isnan(interval_of({}).low));
}

}  // namespace
}  // namespace mien
