#include "mien/metrics/distribution.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "performances_for_tests.h"

namespace mien {
namespace {

using test::noise;
using test::set;
using test::still;

TEST(Regions, AreDisjointAndComplete) {
  EXPECT_EQ(region_channels(FaceRegion::lower).size(), 28u);
  EXPECT_EQ(region_channels(FaceRegion::upper).size(), 11u);
  EXPECT_EQ(region_channels(FaceRegion::gaze).size(), 8u);
  EXPECT_EQ(region_channels(FaceRegion::head).size(), 3u);
  std::vector<bool> seen(55, false);
  for (const FaceRegion region : kFaceRegions) {
    for (const std::size_t c : region_channels(region)) {
      EXPECT_FALSE(seen[c]);
      seen[c] = true;
    }
  }
  EXPECT_THROW(require_performance({MotionSpace::arkit, {"jawOpen"}, 60, {0.f}}), std::logic_error);
  Motion slow = still(3);
  slow.fps = 30;
  EXPECT_THROW(require_performance(slow), std::logic_error);
}

TEST(Diversity, OfIdenticalTakesIsZeroAndOfTwoConstantsTheirDistance) {
  EXPECT_EQ(pair_distance(std::vector<Motion>(3, noise(50, 0.1, 1)), FaceRegion::upper).value(), 0);
  Motion a = still(10), b = still(10), c = still(10);
  set(b, {"jawOpen"}, [](auto) { return 0.28; });
  EXPECT_NEAR(pair_distance(std::vector<Motion>{a, b}, FaceRegion::lower).value(), 0.28 / 28, 1e-7);
  EXPECT_NEAR(pair_distance(std::vector<Motion>{a, b, c}, FaceRegion::lower).value(), 0.28 / 28 * 2 / 3,
              1e-7);
  EXPECT_EQ(pair_distance(std::vector<Motion>{a, b}, FaceRegion::gaze).value(), 0);
  EXPECT_TRUE(std::isnan(pair_distance(std::vector<Motion>{a}, FaceRegion::lower).value()));
  EXPECT_TRUE(std::isnan(pair_distance(std::vector<Motion>{still(0), still(0)}, FaceRegion::lower).value()));
}

TEST(Diversity, OfNoiseFollowsItsDeviation) {
  std::vector<Motion> quiet, loud;
  for (std::uint64_t i = 0; i < 6; ++i)
    quiet.push_back(noise(300, 0.1, i)), loud.push_back(noise(300, 0.2, 10 + i));
  const double expected = 2 * 0.1 / std::sqrt(3.14159265358979);  // mean |x - y| of two normals
  EXPECT_NEAR(pair_distance(quiet, FaceRegion::lower).value(), expected, 0.002);
  EXPECT_NEAR(
      pair_distance(loud, FaceRegion::lower).value() / pair_distance(quiet, FaceRegion::lower).value(), 2,
      0.05);
}

TEST(Jitter, OfAParabolaIsItsCurvatureAndOfALineZero) {
  Motion motion = still(20);
  set(motion, {"headYaw"}, [](auto n) { return 0.5 * static_cast<double>(n * n); });
  set(motion, {"headPitch"}, [](auto n) { return 3.0 * static_cast<double>(n); });
  EXPECT_NEAR(second_difference(std::vector<Motion>{motion}, FaceRegion::head).value(), 1.0 / 3, 1e-6);
  EXPECT_TRUE(std::isnan(second_difference(std::vector<Motion>{still(2)}, FaceRegion::head).value()));
}

TEST(Accuracy, ExcessIsZeroForTheConditionalMeanAndGrowsAwayFromIt) {
  const Motion truth = noise(200, 0.1, 3), mean = still(200);
  EXPECT_NEAR(score_accuracy(mean, mean, truth, FaceRegion::lower).excess_mae(), 0, 1e-12);
  EXPECT_NEAR(score_accuracy(noise(200, 0.1, 4), mean, truth, FaceRegion::lower).excess_rmse(),
              std::sqrt(2.0) - 1, 0.02);
  EXPECT_NEAR(score_accuracy(truth, mean, truth, FaceRegion::lower).excess_mae(), -1, 1e-12);
}

std::vector<Motion> draws(int count, double sd, std::uint64_t seed, std::int64_t frames = 900) {
  std::vector<Motion> out;
  for (int i = 0; i < count; ++i) out.push_back(noise(frames, sd, seed + static_cast<std::uint64_t>(i)));
  return out;
}

CalibrationScore calibration_of(double sd, double offset) {
  std::vector<Motion> samples = draws(8, sd, 100);
  for (Motion& sample : samples)
    for (float& v : sample.values) v += static_cast<float>(offset);
  CalibrationScore sum;
  for (std::uint64_t i = 0; i < 4; ++i)
    sum += score_calibration(samples, noise(900, 0.1, 300 + i), draws(8, 0.1, 200));
  return sum;
}

TEST(Calibration, OfRightSamplesIsIdeal) {
  const CalibrationScore s = calibration_of(0.1, 0);
  for (const RegionCalibration& region : s.regions) {
    EXPECT_NEAR(region.spread_skill(), 1, 0.03);
    EXPECT_NEAR(region.energy_regret(), 0, 0.02);
    EXPECT_NEAR(region.crps_regret(), 0, 0.02);
  }
  for (const RankHistogram& ranks : s.ranks) {
    EXPECT_EQ(ranks.windows, 4 * 30);
    EXPECT_EQ(ranks.counts.size(), 9u);
    EXPECT_LT(ranks.chi_squared_per_degree(), 4);
    EXPECT_NEAR(ranks.coverage_50(), 0.50 * 7 / 9, 0.15);
    EXPECT_NEAR(ranks.coverage_90(), 0.90 * 7 / 9, 0.15);
  }
}

TEST(Calibration, SeesSamplesThatAreTooSureTooWildOrBiased) {
  const CalibrationScore sure = calibration_of(0.02, 0), wild = calibration_of(0.3, 0),
                         biased = calibration_of(0.1, 0.2);
  EXPECT_LT(sure.regions[0].spread_skill(), 0.3);
  EXPECT_GT(wild.regions[0].spread_skill(), 1.9);
  EXPECT_LT(biased.regions[0].spread_skill(), 0.6);
  for (const CalibrationScore* s : {&sure, &wild, &biased}) {
    EXPECT_GT(s->regions[0].energy_regret(), 0.03);
    EXPECT_GT(s->regions[0].crps_regret(), 0.03);
  }
  EXPECT_LT(sure.ranks[0].coverage_50(), 0.3);
  EXPECT_GT(wild.ranks[0].coverage_50(), 0.6);
  EXPECT_GT(biased.ranks[0].chi_squared_per_degree(), 10);
  EXPECT_LT(biased.ranks[0].coverage_90(), 0.2);
}

TEST(Calibration, CrpsOfAKnownCase) {
  // Samples 0 and 1, y = 0: mean |x - y| = 1/2, fair spread term = 1/2 mean over i != j of 1 = 1/2, so CRPS =
  // 0. y = 2: 1.5 - 0.5 = 1.
  Motion zero = still(1), one = still(1), two = still(1);
  for (float& v : one.values) v = 1;
  for (float& v : two.values) v = 2;
  const std::vector<Motion> samples = {zero, one};
  EXPECT_NEAR(score_calibration(samples, zero, samples).regions[0].crps.value(), 0, 1e-12);
  EXPECT_NEAR(score_calibration(samples, two, samples).regions[0].crps.value(), 1, 1e-12);
}

TEST(Calibration, EqualValuesGetEveryRank) {
  const auto s = score_calibration(draws(8, 0, 1, 9000), still(9000), draws(8, 0, 1, 9000));
  EXPECT_LT(s.ranks[3].chi_squared_per_degree(), 3);
  EXPECT_DOUBLE_EQ(s.ranks[3].coverage_50(), 1);
}

TEST(Calibration, NeedsTwoSamplesAndEnoughTruth) {
  EXPECT_THROW((void)score_calibration(draws(1, 1, 1, 60), still(60), draws(8, 1, 1, 60)), std::logic_error);
  EXPECT_THROW((void)score_calibration(draws(4, 1, 1, 60), still(60), draws(3, 1, 1, 60)), std::logic_error);
  EXPECT_THROW((void)score_calibration(draws(4, 1, 1, 60), still(61), draws(4, 1, 1, 60)), std::logic_error);
  EXPECT_TRUE(
      std::isnan(score_calibration(draws(2, 1, 1, 0), still(0), draws(2, 1, 1, 0)).regions[0].crps.value()));
}

}  // namespace
}  // namespace mien
