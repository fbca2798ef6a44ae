#include "mien/datasets/coefficient_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mien/base/file.h"
#include "mien/core/arkit.h"
#include "test_folder.h"

namespace mien {
namespace {

using testing::Contains;
using testing::HasSubstr;

// SAiD's form: names, then rows; column k of row n is n + k / 100.
std::string csv(std::vector<std::string> names, int num_frames) {
  std::string text;
  for (std::size_t k = 0; k < names.size(); ++k) text += (k == 0 ? "" : ",") + names[k];
  for (int n = 0; n < num_frames; ++n) {
    text += '\n';
    for (std::size_t k = 0; k < names.size(); ++k)
      text += (k == 0 ? "" : ",") + std::to_string(n) + (k < 10 ? ".0" : ".") + std::to_string(k);
  }
  return text + "\n";
}

void write(const std::filesystem::path& path, std::string_view text) {
  std::filesystem::create_directories(path.parent_path());
  ASSERT_TRUE(write_file(path, text));
}

TEST(CoefficientFolder, IsListedByPersonSentenceAndRepetition) {
  const TestFolder folder;
  for (const char* name :
       {"B/sentence02.csv", "A/sentence10-10.csv", "A/sentence10-2.csv", "A/sentence09-x.csv",
        "A/sentence10.csv", "A/notes.csv", "A/sentence.csv", "A/sentence01.txt"})
    write(folder.path() / name, "");
  const auto files = list_coefficients(folder.path());
  ASSERT_TRUE(files) << files.error().message();
  std::string order;
  for (const auto& f : *files) order += f.person + std::to_string(f.sentence) + "-" + f.repetition + " ";
  EXPECT_EQ(order, "A9-x A10- A10-2 A10-10 B2- ");
  EXPECT_THAT(files.warnings, Contains(HasSubstr("2 .csv files")));
  EXPECT_EQ(list_coefficients(folder / "A")->front().person, "");
  EXPECT_EQ(list_coefficients(folder / "absent").error().code, Errc::input);
  std::filesystem::create_directory(folder / "empty");
  EXPECT_EQ(list_coefficients(folder / "empty").error().code, Errc::input);
}

TEST(Coefficients, AreGatheredByName) {
  const TestFolder folder;
  auto names = arkit_order(ArkitOrder::said);
  std::swap(names[0], names[3]);
  names.emplace_back("browInnerUp");
  write(folder / "a.csv", csv(names, 3));
  const auto motion = read_coefficients(folder / "a.csv");
  ASSERT_TRUE(motion) << motion.error().message();
  EXPECT_EQ(motion->num_frames(), 3);
  EXPECT_EQ(motion->channels, arkit_order(ArkitOrder::said));
  EXPECT_FLOAT_EQ(motion->frame(2)[0], 2.03f);
  EXPECT_FLOAT_EQ(motion->frame(2)[3], 2.00f);
  EXPECT_FLOAT_EQ(motion->frame(1)[31], 1.31f);
  EXPECT_EQ(motion->fps, kCoefficientFps);
}

TEST(Coefficients, OfAnotherKindAreRefused) {
  const TestFolder folder;
  auto names = arkit_order(ArkitOrder::said);
  names.erase(names.begin() + 4);
  write(folder / "a.csv", csv(names, 3));
  const auto missing = read_coefficients(folder / "a.csv");
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, Errc::incompatible);
  EXPECT_THAT(missing.error().message(), HasSubstr("no column mouthClose"));
  EXPECT_FALSE(read_coefficients(folder / "absent.csv"));
  write(folder / "b.csv", "no,numbers\nhere,!\n");
  EXPECT_FALSE(read_coefficients(folder / "b.csv"));
}

TEST(CoefficientSplit, FollowsTheSpeakers) {
  EXPECT_EQ(coefficient_split("FaceTalk_170731_00024_TA"), "test");
  EXPECT_EQ(coefficient_split("FaceTalk_170908_03277_TA"), "val");
  EXPECT_EQ(coefficient_split("FaceTalk_170725_00137_TA"), "train");
  EXPECT_EQ(coefficient_split("somebody"), "");
}

}  // namespace
}  // namespace mien
