#include "mien/motion/blink.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <stdexcept>

#include "mien/core/arkit.h"

namespace mien {
namespace {

constexpr BlinkEvent kPlain{1.0, 0.08, 0.02, 0.2, 0.9, 0.0, 1.0};

TEST(Blink, ShapeGoesDownFastHoldsAndReopensSlowly) {
  EXPECT_EQ(blink_shape(kPlain, -0.01), 0);
  EXPECT_EQ(blink_shape(kPlain, 0), 0);
  EXPECT_DOUBLE_EQ(blink_shape(kPlain, 0.04), 0.5);
  EXPECT_DOUBLE_EQ(blink_shape(kPlain, 0.09), 1);
  EXPECT_NEAR(blink_shape(kPlain, 0.2), std::pow(0.5, 0.8), 1e-12);
  EXPECT_EQ(blink_shape(kPlain, 0.3), 0);
  EXPECT_EQ(blink_shape(kPlain, 5), 0);
  EXPECT_EQ(blink_shape(BlinkEvent{}, 0), 0);
}

TEST(Blink, DrawnShapesFollowTheirLaws) {
  Rng rng(3);
  double closing = 0, opening = 0;
  int partial = 0;
  constexpr int kNum = 4000;
  for (int i = 0; i < kNum; ++i) {
    const BlinkEvent e = draw_blink(rng);
    ASSERT_GE(e.closing_s, 0.05);
    ASSERT_LE(e.closing_s, 0.12);
    ASSERT_GE(e.hold_s, 0.005);
    ASSERT_LE(e.hold_s, 0.06);
    ASSERT_GE(e.opening_s, 0.12);
    ASSERT_LE(e.opening_s, 0.3);
    ASSERT_TRUE((e.amplitude >= 0.4 && e.amplitude <= 0.75) || (e.amplitude >= 0.92 && e.amplitude <= 1));
    closing += e.closing_s / kNum;
    opening += e.opening_s / kNum;
    partial += e.amplitude < 0.8;
  }
  EXPECT_NEAR(closing, 0.078, 0.001);
  EXPECT_NEAR(opening / closing, 2.4, 0.05);
  EXPECT_NEAR(partial / double(kNum), 0.15, 0.02);
}

TEST(Blink, MovesLidSquintAndWideOfItsOwnEyeOnly) {
  std::vector<float> frame(55, 0.5f);
  apply_blink(frame, {.left = 0.75f, .right = 0.0f});
  for (std::size_t c = 0; c < frame.size(); ++c) {
    if (c == arkit_index("eyeBlinkLeft"))
      EXPECT_FLOAT_EQ(frame[c], 0.75f);
    else if (c == arkit_index("eyeSquintLeft"))
      EXPECT_FLOAT_EQ(frame[c], 0.59f);
    else if (c == arkit_index("eyeWideLeft"))
      EXPECT_FLOAT_EQ(frame[c], 0.125f);
    else
      EXPECT_EQ(frame[c], 0.5f) << c;
  }
  std::vector<float> lowered(52, 0.0f);
  lowered[arkit_index("eyeBlinkRight")] = 0.35f;
  lowered[arkit_index("eyeSquintRight")] = 0.99f;
  apply_blink(lowered, {.left = 0.0f, .right = 0.2f});
  EXPECT_EQ(lowered[arkit_index("eyeBlinkRight")], 0.35f) << "a lid already lower stays";
  EXPECT_EQ(lowered[arkit_index("eyeSquintRight")], 1.0f) << "never above one";
  EXPECT_THROW(apply_blink(std::span(lowered).first(51), {}), std::logic_error);
}

TEST(Blink, OnMotionEqualsFrameByFrame) {
  std::vector<BlinkEvent> events = {kPlain, kPlain, kPlain};
  events[1].onset_s = 1.1;  // overlaps the first
  events[1].right_delay_s = 0.004;
  events[2].onset_s = -0.05;  // began before the motion
  Motion motion{MotionSpace::arkit, arkit_and_head_channels(), 60, std::vector<float>(120 * 55, 0.25f)};
  Motion expected = motion;
  apply_blinks(motion, events);
  for (std::int64_t n = 0; n < 120; ++n)
    apply_blink(expected.frame(n), lid_closure(events, static_cast<double>(n) / 60));
  EXPECT_EQ(motion.values, expected.values);
  EXPECT_GT(motion.frame(66)[0], 0.8f);
  Motion empty;
  apply_blinks(empty, events);
  EXPECT_EQ(empty.num_frames(), 0);
}

TEST(Blink, OnsetsMarkTheNearestFrame) {
  std::vector<BlinkEvent> events(4);
  events[0].onset_s = 0.49 / 60;
  events[1].onset_s = 2.51 / 60;
  events[2].onset_s = -1;
  events[3].onset_s = 100;
  EXPECT_EQ(blink_onsets(events, 5, 60), (std::vector<std::uint8_t>{1, 0, 0, 1, 0}));
  EXPECT_TRUE(blink_onsets(events, 0, 60).empty());
}

}  // namespace
}  // namespace mien
