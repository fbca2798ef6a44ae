#include "mien/tensor/tensor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

namespace mien {
namespace {

using testing::ElementsAre;

TEST(Tensor, StartsEmptyAndZeroed) {
  EXPECT_EQ(Tensor().count(), 0);
  EXPECT_EQ(Tensor().shape(), Shape{0});
  const Tensor t({2, 3});
  EXPECT_THAT(t.values(), testing::Each(0.0f));
  EXPECT_EQ(t.num_rows(), 2);
  EXPECT_EQ(t.width(), 3);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(t.data()) % 64, 0u);
}

TEST(Tensor, SeesRowsThroughAllLeadingAxes) {
  Tensor t({2, 2, 2}, std::vector<float>{0, 1, 2, 3, 4, 5, 6, 7});
  EXPECT_EQ(t.num_rows(), 4);
  EXPECT_THAT(t.row(2), ElementsAre(4, 5));
  EXPECT_EQ(t.size(-1), 2);
  EXPECT_THROW((void)t.row(4), std::logic_error);
  EXPECT_THROW((void)t.size(3), std::logic_error);
}

TEST(Tensor, ScalarsAndEmptyShapesHaveRows) {
  EXPECT_EQ(Tensor(Shape{}).count(), 1);
  EXPECT_EQ(Tensor(Shape{}).num_rows(), 1);
  EXPECT_EQ(Tensor({0, 5}).num_rows(), 0);
  EXPECT_EQ(Tensor({5, 0}).num_rows(), 5);
}

TEST(Tensor, CopiesAreDeepAndMovesLeaveEmptiness) {
  Tensor a({3}, std::vector<float>{1, 2, 3});
  Tensor b = a;
  b.data()[0] = 9;
  EXPECT_THAT(a.values(), ElementsAre(1, 2, 3));
  const Tensor c = std::move(a);
  EXPECT_EQ(a.count(), 0);  // NOLINT: the state after a move is part of the contract
  EXPECT_EQ(a.shape(), Shape{0});
  EXPECT_THAT(c.values(), ElementsAre(1, 2, 3));
  b = c;
  EXPECT_THAT(b.values(), ElementsAre(1, 2, 3));
}

TEST(Tensor, ReshapesTheSameValues) {
  const Tensor t = Tensor({2, 3}, std::vector<float>{1, 2, 3, 4, 5, 6}).reshaped({3, 2});
  EXPECT_THAT(t.row(1), ElementsAre(3, 4));
  EXPECT_THROW((void)t.reshaped({4}), std::logic_error);
}

TEST(Tensor, RefusesImpossibleShapes) {
  EXPECT_THROW(Tensor({-1}), std::logic_error);
  EXPECT_THROW(Tensor({1LL << 40, 1LL << 40}), std::logic_error);
  EXPECT_THROW(Tensor({2}, std::vector<float>{1}), std::logic_error);
}

}  // namespace
}  // namespace mien
