#include "table_reader.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "mien/base/file.h"
#include "test_folder.h"

namespace mien::train {
namespace {

class Fields : public testing::Test {
 protected:
  TomlFile file(const std::string& text) const {
    EXPECT_TRUE(write_file(folder_.path() / "fields.toml", std::string_view(text)));
    auto opened = TomlFile::open(folder_.path() / "fields.toml");
    if (!opened) throw std::runtime_error(opened.error().message());
    return std::move(*opened);
  }
  static std::string complaints(const TomlFile& file) {
    const Status good = file.finish("");
    return good ? "" : good.error().message();
  }
  TestFolder folder_;
};

TEST_F(Fields, NumbersStayInTheirRange) {
  TomlFile f = file("[a]\nwhole = 0\nshare = 1.0\nrate = nan\nbig = inf\nlow = 0\n");
  std::int64_t whole = 3, absent = -1;
  double share_of = 0.5, rate = 1, big = 1, low = 1;
  f.read("a", "whole", whole, at_least(1));
  f.read("a", "share", share_of, share());
  f.read("a", "rate", rate, above_zero());
  f.read("a", "big", big, not_negative());
  f.read("a", "low", low, not_negative());
  f.read("a", "absent", absent, at_least(1));
  const std::string text = complaints(f);
  EXPECT_NE(text.find("[a] whole must be at least 1"), std::string::npos) << text;
  EXPECT_EQ(text.find("share"), std::string::npos) << text;
  EXPECT_NE(text.find("[a] rate"), std::string::npos) << text;
  EXPECT_NE(text.find("[a] big"), std::string::npos) << text;
  EXPECT_EQ(text.find("low"), std::string::npos) << text;
  EXPECT_NE(text.find("[a] absent"), std::string::npos) << "a default outside of its range: " << text;
  TomlFile ends = file("[a]\nshare = 1.0\nzero = 0.0\n");
  ends.read("a", "share", share_of, share_below_one());
  ends.read("a", "zero", low, above_zero());
  EXPECT_NE(complaints(ends).find("[0, 1)"), std::string::npos);
  EXPECT_NE(complaints(ends).find("above 0"), std::string::npos);
}

TEST_F(Fields, WordsAreThoseThatAreKnown) {
  const auto parse = [](const std::string& word) -> std::optional<int> {
    return word == "one" ? std::optional(1) : std::nullopt;
  };
  int value = 7;
  TomlFile good = file("[a]\nword = \"one\"\n");
  good.read_word("a", "absent", value, parse, "one");
  EXPECT_EQ(value, 7);
  good.read_word("a", "word", value, parse, "one");
  EXPECT_EQ(value, 1);
  EXPECT_EQ(complaints(good), "");
  TomlFile other = file("[a]\nword = \"two\"\n");
  other.read_word("a", "word", value, parse, "one");
  EXPECT_NE(complaints(other).find("[a] word 'two' is not one"), std::string::npos) << complaints(other);
  EXPECT_EQ(value, 1);
  TomlFile number = file("[a]\nword = 2\n");
  number.read_word("a", "word", value, parse, "one");
  EXPECT_NE(complaints(number).find("wrong type"), std::string::npos) << complaints(number);
}

TEST_F(Fields, ATableIsThereOrNot) {
  const TomlFile f = file("[a]\n");
  EXPECT_TRUE(f.has_table("a"));
  EXPECT_FALSE(f.has_table("b"));
}

}  // namespace
}  // namespace mien::train
