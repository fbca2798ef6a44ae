#include "mien/render/motion_sheet.h"

#include <gtest/gtest.h>

#include "ball_character.h"

namespace mien {
namespace {

using render_test::ball_character;

constexpr Rgb8 kWhite{255, 255, 255};

Motion opening(float from, float to) {
  return {MotionSpace::arkit, {"jawOpen"}, 10, {from, 0.5f * (from + to), to}};
}

class MotionSheetTest : public testing::Test {
 protected:
  MotionSheetTest() {
    MotionPictureOptions look;
    look.shading.width = 64, look.shading.height = 48;
    for (const Motion* motion : {&still_, &moving_})
      rows_.push_back(MotionPicture::create(character_, {motion}, look).value());
  }
  Character character_ = ball_character();
  Motion still_ = opening(0, 0), moving_ = opening(0, 1);
  std::vector<MotionPicture> rows_;
};

TEST_F(MotionSheetTest, RowsAreMotionsAndColumnsInstants) {
  const std::vector<std::string> labels = {"sad", "happy:3"};
  const std::vector<double> times = {0, 0.1, 0.2};
  const auto sheet = motion_sheet(rows_, labels, times, 2);
  ASSERT_TRUE(sheet) << sheet.error().message();
  const int left = 7 * 6 + 12, top = 12;  // seven letters, and a line of text
  EXPECT_EQ(sheet->width(), left + 3 * 66);
  EXPECT_EQ(sheet->height(), top + 2 * 50);
  for (std::size_t row = 0; row < 2; ++row)
    for (std::size_t column = 0; column < 3; ++column) {
      const Image picture = rows_[row].at(times[column]);
      const int x = left + static_cast<int>(column) * 66, y = top + static_cast<int>(row) * 50;
      for (int j = 0; j < 48; j += 5)
        for (int i = 0; i < 64; i += 5) ASSERT_EQ(sheet->at(x + i, y + j), picture.at(i, j));
      EXPECT_EQ(sheet->at(x + 65, y + 20), kWhite) << "the gap";
    }
  const auto has_ink = [&](int x, int y, int width, int height) {
    for (int j = y; j < y + height; ++j)
      for (int i = x; i < x + width; ++i)
        if (sheet->at(i, j) != kWhite) return true;
    return false;
  };
  EXPECT_TRUE(has_ink(0, top, left, 48)) << "the first name";
  EXPECT_TRUE(has_ink(0, top + 50, left, 48));
  EXPECT_TRUE(has_ink(left, 0, 64, top)) << "the first time";
  EXPECT_FALSE(has_ink(0, 0, left, top));
  EXPECT_EQ(*sheet, motion_sheet(rows_, labels, times, 1).value());
}

TEST_F(MotionSheetTest, LongNamesAreCutAndImpossibleSheetsRefused) {
  const std::vector<std::string> labels(2, std::string(100, 'x'));
  const std::vector<double> one = {0};
  EXPECT_EQ(motion_sheet(rows_, labels, one)->width(), 64 + 12 + 66);
  EXPECT_EQ(motion_sheet(rows_, labels, {}).error().code, Errc::usage);
  EXPECT_EQ(motion_sheet(rows_, labels, std::vector<double>(300)).error().code, Errc::usage);
}

TEST_F(MotionSheetTest, FacesOfAFilmStandInRows) {
  MotionPictureOptions look;
  look.shading.width = 64, look.shading.height = 48, look.columns = 2, look.labels = {"a", "b", "c"};
  const auto film = MotionPicture::create(character_, {&still_, &moving_, &moving_}, look);
  ASSERT_TRUE(film) << film.error().message();
  EXPECT_EQ(film->width(), 128);
  EXPECT_EQ(film->height(), 96);
  const Image picture = film->at(0.2), still = rows_[0].at(0.2), moving = rows_[1].at(0.2);
  for (int i = 20; i < 60; i += 3) {
    EXPECT_EQ(picture.at(i, 30), still.at(i, 30));
    EXPECT_EQ(picture.at(64 + i, 30), moving.at(i, 30));
    EXPECT_EQ(picture.at(i, 48 + 30), moving.at(i, 30));
    EXPECT_EQ(picture.at(64 + i, 48 + 30), look.shading.background_border) << "no fourth face";
  }
}

}  // namespace
}  // namespace mien
