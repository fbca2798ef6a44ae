#include "closeness.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace mien::parity {
namespace {

using testing::HasSubstr;

constexpr Tolerance kTight{"test", 1e-3, 1e-2, ""};

TEST(Closeness, AcceptsWhatTheToleranceAllows) {
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(differences(std::vector{0.0005, 100.9, infinity}, std::vector{0.0, 100.0, infinity}, kTight), "");
  EXPECT_EQ(differences(std::vector<double>{}, std::vector<double>{}, kTight), "");
}

TEST(Closeness, NamesTheWorstValue) {
  const Tensor want({2, 2}, std::vector<float>{0, 0, 0, 0}), got({2, 2}, std::vector<float>{0, 1, 2, 0});
  const std::string text = differences(got, want, kTight);
  EXPECT_THAT(text, HasSubstr("2 of 4"));
  EXPECT_THAT(text, HasSubstr("(1, 0)"));
  EXPECT_EQ(largest_difference(got, want), 2);
}

TEST(Closeness, RefusesNanAndOtherSizes) {
  const double nan = std::nan("");
  EXPECT_NE(differences(std::vector{nan}, std::vector{0.0}, kTight), "");
  EXPECT_NE(differences(std::vector{0.0}, std::vector{nan}, kTight), "");
  EXPECT_NE(differences(std::vector{nan}, std::vector{nan}, kTight), "");
  EXPECT_NE(differences(std::vector{0.0, 0.0}, std::vector{0.0}, kTight), "");
  EXPECT_TRUE(std::isinf(largest_difference(Tensor({1}), Tensor({2}))));
}

TEST(Tolerances, AreKnownByStage) {
  EXPECT_GT(tolerance("schedule").absolute, 0);
  EXPECT_THROW((void)tolerance("no such stage"), std::logic_error);
}

}  // namespace
}  // namespace mien::parity
