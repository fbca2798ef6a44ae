#include "mien/io/edit_csv.h"

#include <gmock/gmock.h>

#include "mien/base/random.h"

namespace mien {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr std::string_view kMask = "jawOpen,mouthSmileLeft\n1,0\n0.25,1.0\r\n\n0,1e-3\n";
constexpr std::string_view kKeys = "time,channel,value\n1.5,jawOpen,0.3\n0.25,headYaw,-12\n2,jawOpen,\n";

TEST(MaskCsv, Reads) {
  const auto table = read_mask_csv(kMask);
  ASSERT_TRUE(table) << table.error().message();
  EXPECT_THAT(table->channels, ElementsAre("jawOpen", "mouthSmileLeft"));
  EXPECT_THAT(table->weights, ElementsAre(1, 0, 0.25f, 1, 0, 1e-3f));
}

TEST(MaskCsv, LeavesOutTheColumnsOfARecording) {
  const auto table = read_mask_csv("\xef\xbb\xbfTimecode,BlendShapeCount, JawOpen \n00:00:00:00.000,61,1\n");
  ASSERT_TRUE(table) << table.error().message();
  EXPECT_THAT(table->channels, ElementsAre("JawOpen"));
  EXPECT_THAT(table->weights, ElementsAre(1));
}

TEST(MaskCsv, SaysWhatIsWrongAndWhere) {
  const auto refusal = [](std::string_view text) {
    const auto table = read_mask_csv(text);
    EXPECT_FALSE(table) << text;
    if (table) return std::string();
    EXPECT_EQ(table.error().code, Errc::input);
    return table.error().message();
  };
  EXPECT_THAT(refusal(""), HasSubstr("empty"));
  EXPECT_THAT(refusal(" \n\r\n"), HasSubstr("empty"));
  EXPECT_THAT(refusal("1,0\n0,1\n"), HasSubstr("names"));
  EXPECT_THAT(refusal("a,,b\n1,1,1\n"), HasSubstr("no name"));
  EXPECT_THAT(refusal("time\n1\n"), HasSubstr("no channel"));
  EXPECT_THAT(refusal("a,b,a\n1,1,1\n"), HasSubstr("twice"));
  EXPECT_THAT(refusal("a,b\n"), HasSubstr("no line"));
  EXPECT_THAT(refusal("a,b\n1,0\n1\n"), HasSubstr("line 3"));
  EXPECT_THAT(refusal("a,b\n1,0,1\n"), HasSubstr("3 fields, expected 2"));
  for (const char* bad : {"1,x", "1,", "1,2", "-0.1,0", "1,nan", "1,inf", "1,1e999", "1,0x1"})
    EXPECT_THAT(refusal("a,b\n" + std::string(bad) + "\n"), HasSubstr("0 to 1")) << bad;
}

TEST(KeysCsv, Reads) {
  const auto keys = read_keys_csv(kKeys);
  ASSERT_TRUE(keys) << keys.error().message();
  ASSERT_EQ(keys->size(), 3u);
  EXPECT_EQ((*keys)[0].seconds, 1.5);
  EXPECT_EQ((*keys)[0].channel, "jawOpen");
  EXPECT_EQ((*keys)[0].value, 0.3f);
  EXPECT_EQ((*keys)[1].value, -12);
  EXPECT_EQ((*keys)[2].value, std::nullopt);
}

TEST(KeysCsv, SaysWhatIsWrongAndWhere) {
  const auto refusal = [](std::string_view text) {
    const auto keys = read_keys_csv(text);
    EXPECT_FALSE(keys) << text;
    if (keys) return std::string();
    EXPECT_EQ(keys.error().code, Errc::input);
    return keys.error().message();
  };
  const std::string header = "time,channel,value\n";
  EXPECT_THAT(refusal(""), HasSubstr("header"));
  EXPECT_THAT(refusal("1.5,jawOpen,0.3\n"), HasSubstr("header"));
  EXPECT_THAT(refusal(header), HasSubstr("none"));
  EXPECT_THAT(refusal(header + "1,a\n"), HasSubstr("2 fields, expected 3"));
  EXPECT_THAT(refusal(header + "1,a,1,1\n"), HasSubstr("line 2"));
  EXPECT_THAT(refusal(header + "x,a,1\n"), HasSubstr("seconds"));
  EXPECT_THAT(refusal(header + "-1,a,1\n"), HasSubstr("seconds"));
  EXPECT_THAT(refusal(header + "nan,a,1\n"), HasSubstr("seconds"));
  EXPECT_THAT(refusal(header + "1,,1\n"), HasSubstr("no channel"));
  EXPECT_THAT(refusal(header + "1,a,b\n"), HasSubstr("finite"));
  EXPECT_THAT(refusal(header + "1,a,inf\n"), HasSubstr("finite"));
  EXPECT_THAT(refusal(header + "1,a,1e200\n"), HasSubstr("finite")) << "too large for a float";
}

// Every beginning, and random bytes anywhere: an error or a table, nothing else.
TEST(EditCsv, SurvivesDamage) {
  const auto check = [](const std::string& text) {
    const auto table = read_mask_csv(text);
    if (table) {
      EXPECT_EQ(table->weights.size() % table->channels.size(), 0u);
    }
    const auto keys = read_keys_csv(text);
    if (keys) {
      EXPECT_FALSE(keys->empty());
    }
  };
  Rng rng(1);
  for (const std::string_view whole : {kMask, kKeys}) {
    for (std::size_t n = 0; n <= whole.size(); ++n) check(std::string(whole.substr(0, n)));
    for (int i = 0; i < 20000; ++i) {
      std::string text(whole);
      for (int k = 0; k < 3; ++k)
        text[static_cast<std::size_t>(rng.below(text.size()))] = static_cast<char>(rng.below(256));
      check(text);
    }
  }
}

}  // namespace
}  // namespace mien
