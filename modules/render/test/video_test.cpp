#include "mien/render/video.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "decode_video.h"
#include "mien/base/file.h"

namespace mien {
namespace {

using render_test::decode_video;
using render_test::DecodedVideo;

constexpr int kRate = 16000;

class Video : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  [[nodiscard]] std::filesystem::path file(const std::string& stem) const {
    return folder_ / (stem + GetParam());
  }

  // Dark film with a bright frame, silence with a click at the same time.
  static Status write(const std::filesystem::path& path, int num_frames, int flash, double fps,
                      int sound_chunk) {
    VideoOptions options;
    options.width = 64, options.height = 48, options.fps = fps, options.sound_rate_hz = kRate;
    MIEN_TRY(auto writer, VideoWriter::create(path, options));
    std::vector<float> sound(static_cast<std::size_t>(std::llround(num_frames / fps * kRate)), 0.0f);
    const auto click = static_cast<std::size_t>((flash + 0.5) / fps * kRate);
    for (std::size_t i = click - 16; i < click + 16; ++i) sound[i] = i % 2 == 0 ? 0.9f : -0.9f;
    std::size_t heard = 0;
    for (int n = 0; n < num_frames; ++n) {
      const std::size_t chunk = std::min(static_cast<std::size_t>(sound_chunk), sound.size() - heard);
      MIEN_TRY([[maybe_unused]] const auto s, writer.add_sound(std::span(sound).subspan(heard, chunk)));
      heard += chunk;
      const std::uint8_t level = n == flash ? 240 : 30;
      MIEN_TRY([[maybe_unused]] const auto f, writer.add_frame(Image(64, 48, {level, level, level})));
    }
    MIEN_TRY([[maybe_unused]] const auto rest, writer.add_sound(std::span(sound).subspan(heard)));
    return writer.finish();
  }

  std::filesystem::path folder_ =
      std::filesystem::path(testing::TempDir()) / ("mien_video_test_" + std::to_string(::getpid()));
};
INSTANTIATE_TEST_SUITE_P(Containers, Video, testing::Values(".mp4", ".webm"),
                         [](const auto& container) { return std::string(container.param + 1); });

double mean_luma(const DecodedVideo::Frame& frame) {
  return std::accumulate(frame.luma.begin(), frame.luma.end(), 0.0) / static_cast<double>(frame.luma.size());
}

TEST_P(Video, KeepsEveryFrameAndClickAndFlashTogether) {
  for (const auto& [num_frames, flash, fps] : {std::tuple(75, 37, 30.0), std::tuple(60, 58, 25.0)}) {
    const auto path = file("flash");
    const Status written = write(path, num_frames, flash, fps, 700);
    ASSERT_TRUE(written.has_value()) << written.error().message();
    const DecodedVideo v = decode_video(path);
    ASSERT_EQ(static_cast<int>(v.frames.size()), num_frames);
    EXPECT_EQ(v.width, 64);
    EXPECT_EQ(v.height, 48);
    for (int n = 0; n < num_frames; ++n) {
      const auto& frame = v.frames[static_cast<std::size_t>(n)];
      EXPECT_NEAR(frame.start, n / fps, 0.0011) << n;  // .webm counts milliseconds
      EXPECT_NEAR(mean_luma(frame), n == flash ? 222 : 42, 4) << n;
    }
    EXPECT_NEAR(v.frames.back().start + v.frames.back().seconds, num_frames / fps, 0.0021);
    // A sound packet may stick out at the end by less than its own length.
    EXPECT_NEAR(v.seconds, num_frames / fps, 0.065);

    ASSERT_FALSE(v.sound.empty());
    const auto loudest = std::max_element(v.sound.begin(), v.sound.end(),
                                          [](float a, float b) { return std::abs(a) < std::abs(b); });
    EXPECT_GT(std::abs(*loudest), 0.2f);
    const double heard = v.sound_start + static_cast<double>(loudest - v.sound.begin()) / v.sound_rate_hz;
    EXPECT_EQ(static_cast<int>(std::floor(heard * fps)), flash);
    // No sample is lost; the encoder may fill its last packet with silence.
    const double seconds = v.sound_start + static_cast<double>(v.sound.size()) / v.sound_rate_hz;
    EXPECT_GE(seconds, num_frames / fps - 0.0015);  // .webm counts milliseconds
    EXPECT_LE(seconds, num_frames / fps + 0.065);
  }
}

TEST_P(Video, EveryPacketHasADurationAndTracksAreInterleaved) {
  const auto path = file("packets");
  ASSERT_TRUE(
      write(path, 90, 30, 30, 100000).has_value());  // all of the sound arrives before the first picture
  const DecodedVideo v = decode_video(path);
  double seconds[2] = {0, 0}, last_time[2] = {0, 0};
  for (std::size_t i = 0; i < v.packet_times.size(); ++i) {
    EXPECT_GT(v.packet_durations[i], 0) << i;
    const std::size_t track = v.packet_is_video[i] ? 1 : 0;
    seconds[track] += v.packet_durations[i];
    last_time[track] = v.packet_times[i];
    if (i > 4) {
      EXPECT_LT(std::abs(last_time[0] - last_time[1]), 0.3) << i;
    }
  }
  EXPECT_NEAR(seconds[1], 3.0, 0.05);
  EXPECT_NEAR(seconds[0], 3.0, 0.13);
}

TEST_P(Video, RepeatsItsBytesHoweverTheSoundArrives) {
  ASSERT_TRUE(write(file("a"), 40, 20, 30, 333).has_value());
  ASSERT_TRUE(write(file("b"), 40, 20, 30, 333).has_value());
  ASSERT_TRUE(write(file("c"), 40, 20, 30, 100000).has_value());
  EXPECT_EQ(*read_file(file("a")), *read_file(file("b")));
  const DecodedVideo a = decode_video(file("a")), c = decode_video(file("c"));
  EXPECT_EQ(a.sound, c.sound);
  EXPECT_EQ(a.frames.size(), c.frames.size());
}

TEST_P(Video, OneSilentFrameIsAFilm) {
  VideoOptions options;
  options.width = 32, options.height = 16, options.fps = 10;
  auto writer = VideoWriter::create(file("one"), options);
  ASSERT_TRUE(writer.has_value()) << writer.error().message();
  ASSERT_TRUE(writer->add_frame(Image(32, 16, {200, 10, 10})).has_value());
  ASSERT_TRUE(writer->finish().has_value());
  const DecodedVideo v = decode_video(file("one"));
  ASSERT_EQ(v.frames.size(), 1u);
  EXPECT_NEAR(v.frames[0].seconds, 0.1, 0.002);
  EXPECT_TRUE(v.sound.empty());
}

TEST_P(Video, SoundThatIsNotANumberIsSilence) {
  VideoOptions options;
  options.width = 32, options.height = 16, options.sound_rate_hz = kRate;
  auto writer = VideoWriter::create(file("nan"), options);
  ASSERT_TRUE(writer.has_value());
  const std::vector<float> sound(1600, std::numeric_limits<float>::quiet_NaN());
  for (int n = 0; n < 3; ++n) ASSERT_TRUE(writer->add_frame(Image(32, 16)).has_value());
  ASSERT_TRUE(writer->add_sound(sound).has_value());
  ASSERT_TRUE(writer->finish().has_value());
  for (const float v : decode_video(file("nan")).sound) EXPECT_NEAR(v, 0, 0.01f);
}

TEST_P(Video, WithoutFinishNothingIsLeft) {
  {
    VideoOptions options;
    options.width = 32, options.height = 16;
    auto writer = VideoWriter::create(file("gone"), options);
    ASSERT_TRUE(writer.has_value());
    ASSERT_TRUE(writer->add_frame(Image(32, 16)).has_value());
  }
  {
    auto writer = VideoWriter::create(file("empty"), {});
    ASSERT_TRUE(writer.has_value());
    EXPECT_FALSE(writer->finish().has_value());  // no frame
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder_));
}

TEST_P(Video, MissingEncodersAndWrongOptionsAreClearErrors) {
  testing::internal::CaptureStderr();
  VideoOptions options;
  options.video_encoder = "libnothing";
  auto writer = VideoWriter::create(file("x"), options);
  ASSERT_FALSE(writer.has_value());
  EXPECT_NE(writer.error().message().find("libnothing"), std::string::npos);
  EXPECT_NE(writer.error().message().find(GetParam()), std::string::npos);
  options = {};
  options.sound_rate_hz = kRate;
  options.sound_encoder = "libx264";  // of the other kind
  EXPECT_FALSE(VideoWriter::create(file("x"), options).has_value());
  options.sound_encoder = "";
  options.sound_rate_hz = 12345;
  writer = VideoWriter::create(file("x"), options);
  ASSERT_FALSE(writer.has_value());
  EXPECT_NE(writer.error().message().find("12345"), std::string::npos);
  const auto code = [this](const VideoOptions& o) {
    const auto w = VideoWriter::create(file("x"), o);
    return w.has_value() ? Errc::failed : w.error().code;
  };
  for (const int size : {0, -2, 33, 100000}) {
    options = {};
    options.width = size;
    EXPECT_EQ(code(options), Errc::usage) << size;
    options = {};
    options.height = size;
    EXPECT_EQ(code(options), Errc::usage) << size;
  }
  for (const double fps : {0.0, -30.0, 1e9, std::numeric_limits<double>::quiet_NaN()}) {
    options = {};
    options.fps = fps;
    EXPECT_EQ(code(options), Errc::usage) << fps;
  }
  EXPECT_FALSE(VideoWriter::create(folder_ / "none" / (std::string("a") + GetParam()), {}).has_value());
  const auto other = VideoWriter::create(folder_ / "a.avi", {});
  ASSERT_FALSE(other.has_value());
  EXPECT_EQ(other.error().code, Errc::usage);
  EXPECT_TRUE(std::filesystem::is_empty(folder_));
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST_P(Video, FramesOfAnotherSizeAreOurMistake) {
  VideoOptions options;
  options.width = 32, options.height = 16;
  auto writer = VideoWriter::create(file("size"), options);
  ASSERT_TRUE(writer.has_value());
  EXPECT_THROW((void)writer->add_frame(Image(16, 32)), std::logic_error);
  EXPECT_THROW((void)writer->add_sound({}), std::logic_error);
}

}  // namespace
}  // namespace mien
