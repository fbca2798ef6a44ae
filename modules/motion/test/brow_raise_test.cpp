#include "mien/motion/brow_raise.h"

#include <gtest/gtest.h>

#include <array>
#include <stdexcept>
#include <vector>

#include "mien/core/arkit.h"

namespace mien {
namespace {

constexpr BrowRaise kPlain{1.0, 0.12, 0.4, 0.25};

TEST(BrowRaise, ShapeRisesAndFallsAndIsZeroBeforeItsOnset) {
  EXPECT_EQ(brow_raise_shape(kPlain, -0.01), 0);
  EXPECT_EQ(brow_raise_shape(kPlain, 0), 0);
  EXPECT_DOUBLE_EQ(brow_raise_shape(kPlain, 0.06), 0.5);
  EXPECT_DOUBLE_EQ(brow_raise_shape(kPlain, 0.12), 1);
  EXPECT_NEAR(brow_raise_shape(kPlain, 0.32), 0.5, 1e-12);
  EXPECT_EQ(brow_raise_shape(kPlain, 0.53), 0);
  EXPECT_EQ(brow_raise_shape(kPlain, 9), 0);
  EXPECT_EQ(brow_raise_shape(BrowRaise{}, 0), 0);
}

TEST(BrowRaise, OverlappingRaisesAddUpToOne) {
  BrowRaise later = kPlain;
  later.onset_s = 1.2;
  EXPECT_FLOAT_EQ(brow_height(std::array{kPlain}, 1.12), 0.25f);
  const double t = 1.35, first = 0.25 * brow_raise_shape(kPlain, t - 1.0),
               second = 0.25 * brow_raise_shape(later, t - 1.2);
  EXPECT_GT(first, 0.01);
  EXPECT_FLOAT_EQ(brow_height(std::array{kPlain, later}, t), static_cast<float>(first + second));
  later.amplitude = 3;
  EXPECT_EQ(brow_height(std::array{later}, t), 1);
  EXPECT_EQ(brow_height({}, t), 0);
}

TEST(BrowRaise, DrawnShapesFollowTheirLaws) {
  Rng rng(3);
  double rise = 0, fall = 0;
  constexpr int kNum = 4000;
  for (int i = 0; i < kNum; ++i) {
    const BrowRaise r = draw_brow_raise(rng);
    ASSERT_GE(r.rise_s, 0.09);
    ASSERT_LE(r.rise_s, 0.12);
    ASSERT_GE(r.fall_s, 0.2);
    ASSERT_LE(r.fall_s, 0.6);
    ASSERT_EQ(r.amplitude, 0);
    rise += r.rise_s / kNum;
    fall += r.fall_s / kNum;
  }
  EXPECT_NEAR(rise, 0.105, 0.001);
  EXPECT_NEAR(fall, 0.351, 0.004);
}

TEST(BrowRaise, MovesTheRaisedBrowTowardsOneAndNothingElse) {
  std::vector<float> frame(55, 0.5f);
  apply_brow_raise(frame, 0.5f);
  for (std::size_t c = 0; c < frame.size(); ++c) {
    if (c == arkit_index("browInnerUp"))
      EXPECT_FLOAT_EQ(frame[c], 0.75f);
    else if (c == arkit_index("browOuterUpLeft") || c == arkit_index("browOuterUpRight"))
      EXPECT_FLOAT_EQ(frame[c], 0.68f);
    else
      EXPECT_EQ(frame[c], 0.5f) << c;
  }
  apply_brow_raise(frame, 1);
  EXPECT_EQ(frame[arkit_index("browInnerUp")], 1);
  std::vector<float> unchanged(55, -0.25f);
  apply_brow_raise(unchanged, 0);
  EXPECT_EQ(unchanged, std::vector<float>(55, -0.25f));
  EXPECT_THROW(apply_brow_raise(std::span(frame).first(51), 0.1f), std::logic_error);
}

}  // namespace
}  // namespace mien
