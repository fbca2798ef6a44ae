#include "mien/render/motion_video.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include "ball_character.h"
#include "decode_video.h"
#include "mien/base/file.h"
#include "mien/render/png.h"

namespace mien {
namespace {

namespace fs = std::filesystem;
using render_test::decode_video;

struct Recorder : Progress {
  void stage(std::string_view, std::int64_t units) override { total = units; }
  void update(std::int64_t units) override {
    EXPECT_GE(units, done);
    done = units;
    if (done >= cancel_at) cancel();
  }
  std::int64_t total = 0, done = 0, cancel_at = 1000000;
};

class MotionFilm : public testing::Test {
 protected:
  void SetUp() override {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    motion_ = {MotionSpace::arkit, {"jawOpen", "headYaw"}, 60, {}};
    for (int n = 0; n < 60; ++n) {
      motion_.values.push_back(n % 20 < 10 ? 0.0f : 1.0f);
      motion_.values.push_back(static_cast<float>(n));
    }
    clip_.samples.assign(20000, 0.1f);  // longer than the motion
  }
  void TearDown() override { fs::remove_all(folder_); }
  [[nodiscard]] MotionPicture picture() const {
    MotionPictureOptions options;
    options.shading.width = 64, options.shading.height = 48;
    return MotionPicture::create(character_, {&motion_}, options).value();
  }

  Character character_ = render_test::ball_character();
  Motion motion_;
  AudioClip clip_;
  fs::path folder_ = fs::path(testing::TempDir()) / ("mien_motion_film_test_" + std::to_string(::getpid()));
};

TEST_F(MotionFilm, ShowsEveryInstantWithSoundCutAtTheEnd) {
  Recorder progress;
  const auto path = folder_ / "a.mp4";
  const Status done = write_motion_video(path, picture(), &clip_, {}, progress);
  ASSERT_TRUE(done.has_value()) << done.error().message();
  EXPECT_EQ(progress.total, 30);
  EXPECT_EQ(progress.done, 30);
  const auto film = decode_video(path);
  ASSERT_EQ(film.frames.size(), 30u);
  EXPECT_NEAR(static_cast<double>(film.sound.size()) / film.sound_rate_hz, 1.0, 0.065);
  // Each decoded frame looks like the picture of its instant, and less like another one.
  const auto distance = [&](std::size_t n, double seconds) {
    const Image image = picture().at(seconds);
    double sum = 0;
    for (int y = 0; y < 48; ++y)
      for (int x = 0; x < 64; ++x) {
        const Rgb8 p = image.at(x, y);
        const double luma = 16 + (0.2126 * p.r + 0.7152 * p.g + 0.0722 * p.b) * 219 / 255;
        sum += std::abs(luma - film.frames[n].luma[static_cast<std::size_t>(y * 64 + x)]);
      }
    return sum / (64 * 48);
  };
  for (const std::size_t n : {0u, 7u, 13u, 29u}) {
    EXPECT_LT(distance(n, static_cast<double>(n) / 30), 3) << n;
    EXPECT_LT(2 * distance(n, static_cast<double>(n) / 30),
              distance(n, static_cast<double>((n + 11) % 30) / 30))
        << n;
  }
}

TEST_F(MotionFilm, SameBytesForAnyNumberOfThreads) {
  Bytes first;
  for (const int threads : {1, 2, 7}) {
    Recorder progress;
    FilmOptions options;
    options.num_threads = threads;
    const auto path = folder_ / "b.webm";
    ASSERT_TRUE(write_motion_video(path, picture(), &clip_, options, progress).has_value());
    const Bytes bytes = read_file(path).value();
    if (first.empty()) first = bytes;
    EXPECT_EQ(bytes, first) << threads;
  }
}

TEST_F(MotionFilm, CancelLeavesNothing) {
  Recorder progress;
  progress.cancel_at = 1;
  const Status status = write_motion_video(folder_ / "c.mp4", picture(), nullptr, {}, progress);
  ASSERT_FALSE(status.has_value());
  EXPECT_EQ(status.error().code, Errc::cancelled);
  EXPECT_LT(progress.done, 30);
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(MotionFilm, WrongInputIsAnError) {
  Recorder progress;
  FilmOptions options;
  options.fps = 0;
  EXPECT_FALSE(write_motion_video(folder_ / "d.mp4", picture(), nullptr, options, progress).has_value());
  EXPECT_FALSE(write_motion_frames(folder_ / "d", picture(), options, progress).has_value());
  EXPECT_FALSE(write_motion_video(folder_ / "d.txt", picture(), nullptr, {}, progress).has_value());
  motion_.values.clear();
  const Status empty = write_motion_video(folder_ / "d.mp4", picture(), nullptr, {}, progress);
  ASSERT_FALSE(empty.has_value());
  EXPECT_NE(empty.error().message().find("no frame"), std::string::npos);
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(MotionFilm, FramesAreNumberedPictures) {
  Recorder progress;
  FilmOptions options;
  options.fps = 10, options.num_threads = 2;
  ASSERT_TRUE(write_motion_frames(folder_ / "deep" / "frames", picture(), options, progress).has_value());
  EXPECT_EQ(progress.done, 10);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_ / "deep" / "frames"), {}), 10);
  EXPECT_EQ(read_png(folder_ / "deep/frames/frame_000003.png").value(), picture().at(0.3));

  options.fps = 5;  // a shorter film into the same folder
  Recorder second;
  const Status again = write_motion_frames(folder_ / "deep" / "frames", picture(), options, second);
  ASSERT_TRUE(again.has_value());
  ASSERT_EQ(again.warnings.size(), 1u);
  EXPECT_NE(again.warnings[0].find("frame_000005.png"), std::string::npos);

  ASSERT_TRUE(write_file(folder_ / "file", "x").has_value());
  EXPECT_FALSE(write_motion_frames(folder_ / "file", picture(), options, progress).has_value());
}

TEST_F(MotionFilm, ContactSheetHasAllCells) {
  const std::vector<SheetCell> cells = {{0, ""}, {0.5, "jaw"}, {0.9, ""}};
  const auto sheet = contact_sheet(picture(), cells, 2, 2);
  ASSERT_TRUE(sheet.has_value());
  EXPECT_EQ(sheet->width(), 64 * 2 + 2);
  EXPECT_EQ(sheet->height(), 48 * 2 + 2);
  EXPECT_EQ(sheet->at(100, 80), (Rgb8{255, 255, 255}));  // no fourth cell
  EXPECT_EQ(sheet->at(32, 24), picture().at(0).at(32, 24));
  EXPECT_EQ(sheet->at(66 + 32, 24), picture().at(0.5).at(32, 24));
  EXPECT_EQ(sheet->at(32, 50 + 24), picture().at(0.9).at(32, 24));
  EXPECT_FALSE(contact_sheet(picture(), {}, 2).has_value());
  EXPECT_FALSE(contact_sheet(picture(), std::vector<SheetCell>(2000), 1).has_value());
  EXPECT_TRUE(make_grid({}, 3).empty());
}

}  // namespace
}  // namespace mien
