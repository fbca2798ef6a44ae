#include "mien/io/coefficient_csv.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "mien/core/arkit.h"

namespace mien {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

Result<std::string> text_of(const Motion& motion) {
  std::string text;
  auto status = write_coefficient_csv(motion, [&](std::string_view piece) -> Status {
    text += piece;
    return Done{};
  });
  if (!status) return status.error();
  Result<std::string> result(text);
  result.warnings = status.warnings;
  return result;
}

TEST(CoefficientCsv, WritesNumbersAsNumpyDoes) {
  Motion motion{MotionSpace::arkit, arkit_order(ArkitOrder::said), 60, std::vector<float>(32)};
  const std::vector<std::pair<float, std::string>> numbers = {{0.0f, "0.0"},
                                                              {1.0f, "1.0"},
                                                              {0.12345679f, "0.12345679"},
                                                              {1e-5f, "1e-05"},
                                                              {1e-4f, "0.0001"},
                                                              {1.5e-7f, "1.5e-07"},
                                                              {0.0010986328f, "0.0010986328"},
                                                              {-0.25f, "-0.25"},
                                                              {-0.0f, "-0.0"},
                                                              {12.5f, "12.5"},
                                                              {100.0f, "100.0"},
                                                              {16777216.0f, "16777216.0"},
                                                              {1e16f, "1e+16"}};
  for (std::size_t i = 0; i < numbers.size(); ++i) motion.values[i] = numbers[i].first;
  const auto text = text_of(motion);
  ASSERT_TRUE(text) << text.error().message();
  const std::string line = text->substr(text->find('\n') + 1);
  std::string want;
  for (const auto& [value, written] : numbers) want += written + ",";
  EXPECT_THAT(line, testing::StartsWith(want));
  EXPECT_THAT(*text, testing::StartsWith("jawForward,jawLeft,jawRight,jawOpen,"));
  EXPECT_TRUE(text.warnings.empty());
}

TEST(CoefficientCsv, HasItsColumnsWhateverTheMotionHas) {
  const Motion motion{MotionSpace::arkit, {"jawOpen", "browInnerUp"}, 30, {0.5f, 0.25f}};
  const auto text = text_of(motion);
  ASSERT_TRUE(text);
  EXPECT_THAT(*text, HasSubstr("\n0.0,0.0,0.0,0.5,0.0,"));
  EXPECT_THAT(text.warnings, ElementsAre(HasSubstr("browInnerUp"), HasSubstr("60 frames")));
}

TEST(CoefficientCsv, RefusesOtherSpacesAndNumbersThatAreNone) {
  EXPECT_FALSE(text_of({MotionSpace::rig, {"a"}, 60, {1}}));
  EXPECT_FALSE(text_of({MotionSpace::arkit, {"jawOpen"}, 60, {std::numeric_limits<float>::quiet_NaN()}}));
}

}  // namespace
}  // namespace mien
