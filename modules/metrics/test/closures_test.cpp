#include "mien/metrics/closures.h"

#include <gtest/gtest.h>

#include <cmath>

#include "labels_for_tests.h"
#include "mien/metrics/baselines.h"

namespace mien {
namespace {

using test::make_labels;
using test::open_except;

// One closure at 1.00 ... 1.10 s between open vowels, silence around.
const SpeechLabels kOne = make_labels({{"sil", 0.5}, {"aa", 0.5}, {"p", 0.1}, {"aa", 0.5}, {"sil", 0.5}});

TEST(Closures, ScaleIsTheNinetiethPercentileInsidePhonesWithAFloor) {
  const OpeningScale scale = opening_scale(open_except(2.1, {}), kOne);
  EXPECT_DOUBLE_EQ(scale.r, 0.4);
  EXPECT_DOUBLE_EQ(scale.theta, 0.15 * 0.4);
  EXPECT_DOUBLE_EQ(opening_scale(shut_aperture(126), kOne).r, 0.05);
  const OpeningScale mesh = opening_scale({ApertureVariant::mesh, std::vector<double>(126, 0.2)}, kOne);
  EXPECT_DOUBLE_EQ(mesh.r, 1.0);
  EXPECT_DOUBLE_EQ(mesh.theta, 0.5);
  Aperture loud_in_silence = open_except(2.1, {});
  for (std::size_t n = 0; n < 30; ++n) loud_in_silence.values[n] = 9;  // the first half second is silence
  EXPECT_DOUBLE_EQ(opening_scale(loud_in_silence, kOne).r, 0.4);
}

TEST(Closures, RunsJoinOverOneOpenFrame) {
  const std::vector<double> a = {0, 1, 0, 1, 1, 0, 0, std::nan("")};
  const auto runs = closed_runs(a, 0.5);
  ASSERT_EQ(runs.size(), 2u);
  EXPECT_EQ(runs[0].first, 0);
  EXPECT_EQ(runs[0].last, 2);
  EXPECT_EQ(runs[1].first, 5);
  EXPECT_EQ(runs[1].last, 6);
  EXPECT_TRUE(closed_runs({}, 0.5).empty());
}

TEST(Closures, APerfectClosureScoresOne) {
  const ClosureScore s = score_closures(open_except(2.1, {{1.0, 1.1}}), kOne, kClosureToleranceSeconds);
  EXPECT_EQ(s.targets, 1);
  EXPECT_EQ(s.hits, 1);
  EXPECT_EQ(s.sealed, 1);
  EXPECT_EQ(s.true_positives, 1);
  EXPECT_EQ(s.false_positives, 0);
  EXPECT_DOUBLE_EQ(s.f1(), 1);
  ASSERT_EQ(s.timing_errors_ms.size(), 1u);
  EXPECT_NEAR(s.timing_errors_ms[0], 0, 1e-9);
  EXPECT_DOUBLE_EQ(s.depth(), 0);
}

TEST(Closures, AShiftIsReportedAsTimingUntilItLeavesTheWindow) {
  const ClosureScore late = score_closures(open_except(2.1, {{1.1, 1.2}}), kOne, kClosureToleranceSeconds);
  EXPECT_EQ(late.hits, 1);
  EXPECT_NEAR(late.timing_bias_ms(), 100, 1e-9);
  EXPECT_EQ(score_closures(open_except(2.1, {{1.1, 1.2}}), kOne, 0.020).hits, 1);
  const ClosureScore lost = score_closures(open_except(2.1, {{1.2, 1.3}}), kOne, kClosureToleranceSeconds);
  EXPECT_EQ(lost.hits, 0);
  EXPECT_EQ(lost.true_positives, 0);
  EXPECT_EQ(lost.false_positives, 1);
  EXPECT_DOUBLE_EQ(lost.f1(), 0);
  const ClosureScore early = score_closures(open_except(2.1, {{0.9, 1.0}}), kOne, kClosureToleranceSeconds);
  EXPECT_NEAR(early.timing_bias_ms(), -100, 1e-9);
}

TEST(Closures, AMouthAlwaysShutHitsNothingAndPaysForItsLength) {
  const ClosureScore s = score_closures(shut_aperture(126), kOne, kClosureToleranceSeconds);
  EXPECT_EQ(s.hits, 0);
  EXPECT_EQ(s.true_positives, 1);
  EXPECT_EQ(s.false_positives, 6);  // 125 frame steps = 2.083 s hold six times 300 ms
  EXPECT_DOUBLE_EQ(s.f1(), 0);
}

TEST(Closures, AMouthAlwaysOpenHasNoPrecision) {
  const ClosureScore s = score_closures(open_except(2.1, {}), kOne, kClosureToleranceSeconds);
  EXPECT_EQ(s.hits, 0);
  EXPECT_TRUE(std::isnan(s.precision()));
  EXPECT_DOUBLE_EQ(s.f1(), 0);
}

TEST(Closures, ClosedButNotTouchingIsAHitThatDoesNotSeal) {
  Aperture a = open_except(2.1, {{1.0, 1.1}});
  for (double& v : a.values)
    if (v == 0) v = 0.05;  // below theta = 0.06
  const ClosureScore s = score_closures(a, kOne, kClosureToleranceSeconds);
  EXPECT_EQ(s.hits, 1);
  EXPECT_EQ(s.sealed, 0);
  EXPECT_DOUBLE_EQ(s.depth(), 0.05 / 0.4);
}

TEST(Closures, AMouthThatHardlyOpensNearbyHitsNothing) {
  Aperture a = open_except(2.1, {{1.0, 1.1}});
  const auto open_nearby = [&](double opening) {
    for (std::size_t n = 45; n <= 81; ++n)  // 0.75 ... 1.35 s
      if (a.values[n] != 0) a.values[n] = opening;
    return score_closures(a, kOne, kClosureToleranceSeconds).hits;
  };
  EXPECT_EQ(open_nearby(0.13), 0);  // theta + 0.20 R = 0.06 + 0.08
  EXPECT_EQ(open_nearby(0.15), 1);
}

TEST(Closures, RestingLipsInSilenceAreNotCounted) {
  const ClosureScore s =
      score_closures(open_except(2.1, {{0, 0.45}, {1.0, 1.1}, {1.7, 2.1}}), kOne, kClosureToleranceSeconds);
  EXPECT_EQ(s.true_positives, 1);
  EXPECT_EQ(s.false_positives, 0);
}

TEST(Closures, HalfInSilenceStillCounts) {
  // 12 frames, 6 of them in the silence that starts at 1.6 s: not more than half.
  const ClosureScore s =
      score_closures(open_except(2.1, {{1.0, 1.1}, {1.5, 1.6 + 5.0 / 60}}), kOne, kClosureToleranceSeconds);
  EXPECT_EQ(s.false_positives, 1);
}

TEST(Closures, RunsAtFAndVAndAtDoubtfulClosuresAreIgnored) {
  SpeechLabels labels =
      make_labels({{"aa", 0.5}, {"f", 0.1}, {"aa", 0.5}, {"m", 0.1}, {"aa", 0.5}, {"p", 0.1}, {"aa", 0.5}});
  labels.rows[3].flags = kDoubtful;
  const ClosureScore s = score_closures(open_except(2.3, {{0.5, 0.6}, {1.1, 1.2}, {1.7, 1.8}}), labels, 0.05);
  EXPECT_EQ(s.targets, 1);
  EXPECT_EQ(s.true_positives, 1);
  EXPECT_EQ(s.false_positives, 0);
  labels.rows[1].phone = "s";
  EXPECT_EQ(
      score_closures(open_except(2.3, {{0.5, 0.6}, {1.1, 1.2}, {1.7, 1.8}}), labels, 0.05).false_positives,
      1);
}

TEST(Closures, MergedRowsAreOneEventWithoutTiming) {
  SpeechLabels labels = make_labels({{"aa", 0.5}, {"m", 0.1}, {"p", 0.1}, {"aa", 0.5}});
  labels.rows[1].closure = labels.rows[2].closure = ClosureWindow{0.5, 0.7};
  labels.rows[1].flags = kMerged;
  labels.rows[2].flags = kMerged | kSameEvent;
  const ClosureScore s = score_closures(open_except(1.2, {{0.5, 0.7}}), labels, 0.05);
  EXPECT_EQ(s.targets, 1);
  EXPECT_EQ(s.hits, 1);
  EXPECT_TRUE(s.timing_errors_ms.empty());
}

TEST(Closures, ALongClosureAddsOneFalsePositivePerFull300Milliseconds) {
  const auto false_positives = [](double seconds) {
    return score_closures(open_except(2.1, {{1.0, 1.0 + seconds}}), kOne, 0.05).false_positives;
  };
  EXPECT_EQ(false_positives(17.0 / 60), 0);
  EXPECT_EQ(false_positives(18.0 / 60), 1);
}

TEST(Closures, TheRunNearestToTheCentreIsTimed) {
  const ClosureScore s = score_closures(open_except(2.1, {{0.95, 0.9667}, {1.05, 1.0667}}), kOne, 0.05);
  ASSERT_EQ(s.timing_errors_ms.size(), 1u);
  EXPECT_NEAR(s.timing_errors_ms[0], 1000 * (63.5 / 60 - 1.05), 1e-6);
  EXPECT_EQ(s.true_positives, 2);
}

TEST(Closures, ScoresAddUp) {
  ClosureScore sum;
  for (int i = 0; i < 3; ++i) sum += score_closures(open_except(2.1, {{1.0, 1.1}}), kOne, 0.05);
  sum += score_closures(open_except(2.1, {}), kOne, 0.05);
  EXPECT_EQ(sum.targets, 4);
  EXPECT_DOUBLE_EQ(sum.hit_rate(), 0.75);
  EXPECT_DOUBLE_EQ(sum.precision(), 1);
  EXPECT_NEAR(sum.f1(), 2 * 0.75 / 1.75, 1e-12);
}

TEST(Closures, EmptyInputScoresNothing) {
  EXPECT_EQ(score_closures({}, kOne, 0.05).hits, 0);
  EXPECT_EQ(score_closures({}, kOne, 0.05).targets, 1);
  EXPECT_TRUE(std::isnan(score_closures({}, {}, 0.05).f1()));
  EXPECT_EQ(score_closures(open_except(1, {}), {}, 0.05).false_positives, 0);
}

}  // namespace
}  // namespace mien
