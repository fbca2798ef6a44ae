#include "mien/io/metahuman_csv.h"

#include <gtest/gtest.h>

#include "mien/io/live_link_csv.h"

namespace mien {
namespace {

Result<std::string> text_of(const Motion& motion, std::vector<std::string>& warnings) {
  std::string text;
  const auto status = write_metahuman_csv(motion, [&](std::string_view piece) -> Status {
    text += piece;
    return Done{};
  });
  if (!status) return status.error();
  warnings = status.warnings;
  return text;
}

TEST(MetahumanCsv, IsReadBackByName) {
  const Motion motion{
      MotionSpace::arkit, {"jawOpen", "tongueOut", "browDownLeft"}, 30, {0.25f, 1, 0, 0.5f, 1, 0.125f}};
  std::vector<std::string> warnings;
  const auto text = text_of(motion, warnings);
  ASSERT_TRUE(text) << text.error().message();
  EXPECT_TRUE(text->starts_with("Timecode,BlendShapeCount,BrowDownLeft,BrowDownRight,"));
  EXPECT_NE(text->find("\n00:00:00:02.000,51,0.125,0,"), std::string::npos);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("tongueOut"), std::string::npos);
  const auto read = read_live_link_csv(*text, {});
  ASSERT_TRUE(read) << read.error().message();
  ASSERT_EQ(read->num_frames(), 2);
  EXPECT_EQ(read->frame(1)[static_cast<std::size_t>(*read->find("jawOpen"))], 0.5f);
}

TEST(MetahumanCsv, ClockLosesTheRoundingOfEveryRow) {
  EXPECT_EQ(metahuman_timecode(0, 30), "00:00:00:00.000");
  EXPECT_EQ(metahuman_timecode(30, 30), "00:00:00:59.999");
  EXPECT_EQ(metahuman_timecode(50 * 3600, 50), "01:00:00:00.000");
  EXPECT_EQ(metahuman_timecode(24ll * 3600 * 50, 50), "00:00:00:00.000");
}

TEST(MetahumanCsv, OtherMotionIsAnError) {
  std::vector<std::string> warnings;
  EXPECT_EQ(text_of(vertex_motion({"", 1}, 30), warnings).error().code, Errc::incompatible);
  EXPECT_TRUE(text_of(Motion{MotionSpace::arkit, {"jawOpen"}, 30, {}}, warnings));
}

}  // namespace
}  // namespace mien
