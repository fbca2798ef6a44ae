#include "mien/metrics/face_events.h"

#include <gtest/gtest.h>

#include <cmath>

#include "performances_for_tests.h"

namespace mien {
namespace {

using test::set;
using test::still;

// Lids that close in 4 frames, hold one and open in 8, starting at the given frames.
Motion blinking(std::int64_t num_frames, const std::vector<std::int64_t>& onsets, double amplitude = 1) {
  Motion motion = still(num_frames);
  set(motion, {"eyeBlinkLeft", "eyeBlinkRight"}, [&](std::int64_t n) {
    for (const std::int64_t onset : onsets) {
      const auto t = static_cast<double>(n - onset);
      if (t >= 0 && t <= 4) return amplitude * t / 4;
      if (t > 4 && t < 13) return amplitude * (1 - (t - 5) / 8);
    }
    return 0.0;
  });
  return motion;
}

TEST(Blinks, AreCountedTimedAndPlaced) {
  const Motion motion = blinking(600, {60, 180, 240});
  const auto blinks = detect_blinks(motion);
  ASSERT_EQ(blinks.size(), 3u);
  EXPECT_NEAR(blinks[0].onset, 1.0, 1e-9);
  EXPECT_NEAR(blinks[0].time, 62.0 / 60, 1e-9);
  EXPECT_NEAR(blinks[0].closing, 4.0 / 60, 1e-9);  // 10 % is passed between frames 60 and 61, 90 % at 64
  EXPECT_NEAR(blinks[0].opening, 8.0 / 60, 1e-9);
  const std::vector<TimeInterval> pauses = {{0.9, 1.1}, {3.5, 5}};
  const BlinkScore s = score_blinks(motion, pauses);
  EXPECT_EQ(s.blinks, 3);
  EXPECT_EQ(s.in_pauses, 2);
  EXPECT_DOUBLE_EQ(s.per_minute(), 18);
  ASSERT_EQ(s.intervals_s.size(), 2u);
  EXPECT_NEAR(s.intervals_s[0], 2, 1e-9);
  EXPECT_NEAR(s.intervals_s[1], 1, 1e-9);
}

TEST(Blinks, HalfClosedLidsAreNone) {
  EXPECT_TRUE(detect_blinks(blinking(300, {50}, 0.45)).empty());
  EXPECT_TRUE(detect_blinks(still(100)).empty());
  EXPECT_TRUE(detect_blinks(still(0)).empty());
  Motion shut = still(100);
  set(shut, {"eyeBlinkLeft", "eyeBlinkRight"}, [](auto) { return 1.0; });
  EXPECT_TRUE(detect_blinks(shut).empty());
  Motion wink = still(100);
  set(wink, {"eyeBlinkLeft"}, [](auto n) { return n == 50 ? 0.9 : 0.0; });
  EXPECT_TRUE(detect_blinks(wink).empty());
  EXPECT_TRUE(std::isnan(BlinkScore{}.per_minute()));
}

Motion raises_at(std::int64_t num_frames, const std::vector<std::int64_t>& centres, std::string_view channel,
                 double height) {
  Motion motion = still(num_frames);
  set(motion, {channel}, [&](std::int64_t n) {
    for (const std::int64_t c : centres)
      if (std::abs(n - c) < 12) return height * (1 - static_cast<double>(std::abs(n - c)) / 12);
    return 0.0;
  });
  return motion;
}

TEST(Gestures, BrowRaisesAndNodsArePeaks) {
  const auto raises = detect_brow_raises(raises_at(300, {60, 200}, "browInnerUp", 0.3));
  ASSERT_EQ(raises.size(), 2u);
  EXPECT_NEAR(raises[0], 1.0, 1e-9);
  EXPECT_TRUE(detect_brow_raises(raises_at(300, {60}, "browInnerUp", 0.05)).empty());
  const auto nods = detect_nods(raises_at(300, {60, 200}, "headPitch", -2.5));
  ASSERT_EQ(nods.size(), 2u);
  EXPECT_NEAR(nods[1], 200.0 / 60, 1e-9);
  EXPECT_TRUE(detect_nods(raises_at(300, {60}, "headPitch", 2.5)).size() <=
              1);  // looking up: at most its return
}

TEST(Gestures, APlateauIsOneRaise) {
  Motion motion = still(200);
  set(motion, {"browInnerUp"}, [](auto n) { return n < 100 ? 0.0 : 0.3; });
  EXPECT_EQ(detect_brow_raises(motion).size(), 1u);
}

TEST(Gestures, LiftComparesAccentsWithChance) {
  const std::vector<double> accents = {1, 3, 5, 7};
  const AccentScore all = score_accents(accents, accents, 600);
  EXPECT_DOUBLE_EQ(all.rate(), 1);
  EXPECT_NEAR(all.lift(), 600.0 / (4 * 19), 1e-9);  // each event covers 19 frames
  const AccentScore none = score_accents(std::vector<double>{2, 4}, accents, 600);
  EXPECT_DOUBLE_EQ(none.lift(), 0);
  EXPECT_TRUE(std::isnan(score_accents({}, accents, 600).lift()));
  std::vector<double> everywhere;
  for (int n = 0; n < 600; ++n) everywhere.push_back(n / 60.0);
  EXPECT_DOUBLE_EQ(score_accents(everywhere, accents, 600).lift(), 1);
}

TEST(Gaze, DwellTimesLeaveOutWhatTheEndsCut) {
  Motion motion = still(360);
  // 1 s contact, 0.5 s to the left, 2 s contact, 0.5 s up, the rest contact.
  const auto left = [](auto n) { return n >= 60 && n < 90 ? 10.0 / 33 : 0.0; };
  set(motion, {"eyeLookOutLeft", "eyeLookInRight"}, left);
  set(motion, {"eyeLookUpLeft", "eyeLookUpRight"},
      [](auto n) { return n >= 210 && n < 240 ? 5.0 / 28 : 0.0; });
  const GazeScore s = score_gaze(motion);
  ASSERT_EQ(s.contact_s.size(), 1u);
  EXPECT_NEAR(s.contact_s[0], 2, 1e-9);
  ASSERT_EQ(s.away_s.size(), 2u);
  EXPECT_NEAR(s.away_s[0], 0.5, 1e-9);
  EXPECT_NEAR(s.share_away(), 60.0 / 360, 1e-9);
  // Eyes that turn against each other look at the viewer on average.
  Motion crossed = still(60);
  set(crossed, {"eyeLookInLeft", "eyeLookInRight"}, [](auto) { return 0.5; });
  EXPECT_EQ(score_gaze(crossed).away_frames, 0);
}

}  // namespace
}  // namespace mien
