#include "mien/metrics/lip_accuracy.h"

#include <gtest/gtest.h>

#include <cmath>

#include "performances_for_tests.h"

namespace mien {
namespace {

using test::set;
using test::still;

// An open mouth that closes and presses during [first, last] + shift.
Motion closing(const std::vector<std::pair<int, int>>& closures, int shift = 0, double press = 0.4) {
  Motion motion = still(300);
  const auto inside = [&](std::int64_t n) {
    for (const auto& [first, last] : closures)
      if (n >= first + shift && n <= last + shift) return true;
    return false;
  };
  set(motion, {"jawOpen"}, [](auto n) { return 0.3 + 0.1 * std::sin(0.2 * static_cast<double>(n)); });
  set(motion, {"mouthClose"},
      [&](auto n) { return inside(n) ? 0.3 + 0.1 * std::sin(0.2 * static_cast<double>(n)) : 0.0; });
  set(motion, {"mouthPressLeft", "mouthPressRight"}, [&](auto n) { return inside(n) ? press : 0.0; });
  return motion;
}

const std::vector<std::pair<int, int>> kClosures = {{60, 66}, {120, 126}, {200, 206}};

TEST(LipAccuracy, OfTheTruthIsOne) {
  const Motion truth = closing(kClosures);
  const LipAccuracy s = score_lips(truth, std::vector<Motion>(2, truth), 1);
  EXPECT_NEAR(s.jaw_r(), 1, 1e-9);
  EXPECT_NEAR(s.mean_r(), 1, 1e-9);  // over the three curves that move
  EXPECT_TRUE(std::isnan(s.curves[2].r()));
  EXPECT_EQ(s.closures.events, 3);
  EXPECT_DOUBLE_EQ(s.closures.frame_f1(), 1);
  EXPECT_DOUBLE_EQ(s.closures.hit_rate(), 1);
  EXPECT_DOUBLE_EQ(s.seal(), 1);
  EXPECT_EQ(s.seal_chances, 6);
  for (const double ms : s.timing_errors_ms) EXPECT_EQ(ms, 0);
}

TEST(LipAccuracy, ShiftedClosuresLoseFramesBeforeEvents) {
  const Motion truth = closing(kClosures);
  const LipAccuracy two = score_lips(truth, std::vector<Motion>{closing(kClosures, 2)}, 1);
  EXPECT_NEAR(two.closures.frame_f1(), 5.0 / 7, 1e-12);
  EXPECT_DOUBLE_EQ(two.closures.tolerant_f1(), 1);
  EXPECT_DOUBLE_EQ(two.closures.hit_rate(), 1);
  const LipAccuracy nine = score_lips(truth, std::vector<Motion>{closing(kClosures, 9)}, 1);
  EXPECT_DOUBLE_EQ(nine.closures.frame_f1(), 0);
  EXPECT_DOUBLE_EQ(nine.closures.hit_rate(), 0);
  EXPECT_DOUBLE_EQ(nine.closures.precision(), 0);
}

TEST(LipAccuracy, AlwaysPressedHitsAllWithPoorPrecision) {
  const LipAccuracy s = score_lips(closing(kClosures), std::vector<Motion>{closing({{0, 299}})}, 1);
  EXPECT_DOUBLE_EQ(s.closures.hit_rate(), 1);
  EXPECT_NEAR(s.closures.frame_f1(), 2 * (21.0 / 300) / (21.0 / 300 + 1), 1e-12);
}

TEST(LipAccuracy, ThresholdsScaleWithThePressGain) {
  const Motion truth = closing(kClosures, 0, 0.20);
  EXPECT_EQ(score_lips(truth, std::vector<Motion>{truth}, 1).closures.events, 0);
  EXPECT_EQ(score_lips(truth, std::vector<Motion>{truth}, 0.7).closures.events, 3);
  const Motion weak = closing(kClosures, 0, 0.17);  // over the prediction's threshold only
  EXPECT_DOUBLE_EQ(score_lips(closing(kClosures), std::vector<Motion>{weak}, 1).closures.hit_rate(), 1);
  EXPECT_EQ(score_lips(closing(kClosures), std::vector<Motion>{weak}, 0).closures.events, 0);
}

TEST(LipAccuracy, SealLooksAtSingleTakes) {
  const Motion truth = closing(kClosures);
  Motion open = truth;
  set(open, {"mouthClose"}, [](auto) { return 0.0; });
  EXPECT_DOUBLE_EQ(score_lips(truth, std::vector<Motion>{truth, open}, 1).seal(), 0.5);
}

TEST(LipAccuracy, RoundingOnsetsAreTimedAtHalfHeight) {
  const auto rounded = [](int shift, double height) {
    Motion motion = still(300);
    set(motion, {"mouthPucker"}, [&](std::int64_t n) {
      const double distance = std::abs(static_cast<double>(n - 100 - shift));
      return distance < 20 ? height * (1 - distance / 20) : 0.0;
    });
    return motion;
  };
  const RoundingScore same = score_rounding(rounded(0, 0.8), rounded(0, 0.4));
  EXPECT_EQ(same.events, 1);
  EXPECT_EQ(same.found, 1);
  EXPECT_NEAR(same.onset_errors_ms.at(0), 0, 1e-3);  // the height does not matter
  EXPECT_NEAR(score_rounding(rounded(0, 0.8), rounded(3, 0.8)).onset_errors_ms.at(0), 50, 1e-3);
  EXPECT_EQ(score_rounding(rounded(0, 0.8), rounded(0, 0.1)).found, 0);
  EXPECT_EQ(score_rounding(rounded(0, 0.8), rounded(100, 0.8)).found, 0);
  EXPECT_EQ(score_rounding(rounded(0, 0.2), rounded(0, 0.8)).events, 0);
  EXPECT_TRUE(std::isnan(score_rounding(still(0), still(0)).hit_rate()));
}

TEST(LipAccuracy, CorrelationsPoolOverFramesNotClips) {
  Motion low = still(100), high = still(100);
  set(low, {"jawOpen"}, [](auto n) { return 0.01 * static_cast<double>(n % 2); });
  set(high, {"jawOpen"}, [](auto n) { return 0.5 + 0.01 * static_cast<double>((n + 1) % 2); });
  Motion high_flipped = high;
  set(high_flipped, {"jawOpen"}, [](auto n) { return 0.5 + 0.01 * static_cast<double>(n % 2); });
  LipAccuracy s = score_lips(low, std::vector<Motion>{low}, 0);
  s += score_lips(high, std::vector<Motion>{high_flipped}, 0);
  EXPECT_GT(s.jaw_r(), 0.99);  // the level between the clips counts
}

}  // namespace
}  // namespace mien
