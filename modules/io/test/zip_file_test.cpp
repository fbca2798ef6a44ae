#include "mien/io/zip_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io_test_support.h"
#include "zip_for_tests.h"

namespace mien {
namespace {

using testing::HasSubstr;

std::string content(const ZipFile& zip, std::string_view name) {
  Bytes unpacked;
  const auto* entry = zip.find(name);
  if (entry == nullptr) return "absent";
  const auto bytes = zip.read(*entry, unpacked);
  return bytes ? std::string(as_text(*bytes)) : bytes.error().message();
}

TEST(ZipFile, ReadsStoredAndDeflatedEntries) {
  const std::string text(1000, 'x');
  const Bytes bytes =
      test::make_zip({{"a/b", "hello"}, {"c", text, true}, {"empty", ""}, {"nothing", "", true}});
  const auto zip = ZipFile::parse(bytes, "z");
  ASSERT_TRUE(zip) << zip.error().message();
  EXPECT_TRUE(ZipFile::looks_like(bytes));
  EXPECT_EQ(zip->entries().size(), 4u);
  EXPECT_EQ(content(*zip, "a/b"), "hello");
  EXPECT_EQ(content(*zip, "c"), text);
  EXPECT_EQ(content(*zip, "empty"), "");
  EXPECT_EQ(content(*zip, "nothing"), "");
  EXPECT_EQ(zip->find("d"), nullptr);
}

TEST(ZipFile, ChecksumsAreThoseOfZlib) {
  for (std::size_t size = 0; size < 40; ++size) {
    std::string text;
    for (std::size_t i = 0; i < size; ++i) text.push_back(static_cast<char>(i * 37 + size));
    const Bytes bytes = test::make_zip({{"a", text}});
    EXPECT_EQ(content(*ZipFile::parse(bytes, "z"), "a"), text);
  }
}

TEST(ZipFile, NoticesDamage) {
  Bytes bytes = test::make_zip({{"a", "hello"}, {"b", std::string(1000, 'x'), true}});
  Bytes flipped = bytes;
  flipped[31] ^= std::byte{1};  // behind the header of 30 bytes and the name of one
  EXPECT_THAT(content(*ZipFile::parse(flipped, "z"), "a"), HasSubstr("checksum differs"));
  const auto reject = [](const Bytes& b) {
    const auto zip = ZipFile::parse(b, "z");
    return zip ? std::string("accepted") : zip.error().message();
  };
  EXPECT_THAT(reject({}), HasSubstr("truncated"));
  EXPECT_THAT(reject(Bytes(bytes.begin(), bytes.end() - 1)), HasSubstr("truncated"));
  EXPECT_THAT(reject(test::make_zip({{"a", "1"}, {"a", "2"}})), HasSubstr("two entries 'a'"));
}

TEST(ZipFile, RefusesBombs) {
  const auto reject = [](const Bytes& b) {
    const auto zip = ZipFile::parse(b, "z");
    return zip ? std::string("accepted") : zip.error().message();
  };
  test::ZipPart bomb{"bomb", std::string(2000, 'x'), true};
  bomb.claimed_size = 1u << 30;
  EXPECT_THAT(reject(test::make_zip({bomb})), HasSubstr("more than 100 times its size"));
  bomb.claimed_size = 60u << 20;  // allowed to try, but the data are what they are
  const Bytes lying = test::make_zip({bomb});
  EXPECT_THAT(content(*ZipFile::parse(lying, "z"), "bomb"), HasSubstr("does not unpack to"));
  bomb.claimed_size = 10;
  const Bytes overfull = test::make_zip({bomb});
  EXPECT_THAT(content(*ZipFile::parse(overfull, "z"), "bomb"), HasSubstr("does not unpack to"));
  test::ZipPart same{"same", "", false};
  same.local_of = 0;
  EXPECT_THAT(reject(test::make_zip({{"first", "hello"}, same})), HasSubstr("overlap"));
}

TEST(ZipFile, SurvivesEveryTruncationAndFlip) {
  test::torture(
      test::make_zip({{"a", "hello"}, {"b", std::string(300, 'x'), true}}),
      [](const Bytes& bytes) {
        const auto zip = ZipFile::parse(bytes, "z");
        if (!zip) return false;
        bool fine = true;
        for (const auto& entry : zip->entries()) {
          Bytes unpacked;
          fine &= zip->read(entry, unpacked).has_value();
        }
        return fine;
      },
      [](std::size_t) { return false; });
}

}  // namespace
}  // namespace mien
