#include "mien/core/flame_parameters.h"

#include <gtest/gtest.h>

namespace mien {
namespace {

TEST(FlameParameters, NamesStandAtTheirColumns) {
  const auto all = flame_channels(kNumFlameShape, kNumFlameExpression);
  ASSERT_EQ(all.size(), kNumFlame);
  for (std::size_t c = 0; c < all.size(); ++c) EXPECT_EQ(flame_column(all[c]), c) << all[c];
  const auto some = flame_channels(0, 50);
  ASSERT_EQ(some.size(), 53u);
  EXPECT_EQ(some.front(), "expression_0");
  EXPECT_EQ(flame_column(some.front()), 300u);
  EXPECT_EQ(flame_column(some.back()), 402u);
  EXPECT_THROW((void)flame_channels(301, 0), std::logic_error);
}

TEST(FlameParameters, OtherNamesHaveNoColumn) {
  for (const char* name : {"", "shape_", "shape_300", "expression_100", "expression_-1", "expression_1x",
                           "expression_01", "expression_99999999999999999999", "jaw", "jaw_w", "Shape_1"})
    EXPECT_FALSE(flame_column(name)) << name;
  Motion motion{MotionSpace::flame, {"jaw_y", "blink"}, 25, {}};
  const auto columns = flame_columns(motion);
  EXPECT_EQ(columns[0], 401u);
  EXPECT_FALSE(columns[1]);
  motion.space = MotionSpace::rig;
  EXPECT_THROW((void)flame_columns(motion), std::logic_error);
}

}  // namespace
}  // namespace mien
