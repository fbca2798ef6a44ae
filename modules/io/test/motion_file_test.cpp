#include "mien/io/motion_file.h"

#include <cmath>
#include <fstream>

#include "io_test_support.h"
#include "mien/base/file.h"
#include "mien/base/random.h"
#include "mien/core/arkit.h"
#include "mien/io/gltf_writer.h"
#include "mien/io/npy.h"

namespace mien {
namespace {

using namespace test;
namespace fs = std::filesystem;

class MotionFile : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) /
              (std::string("motion_file_") + testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  Motion motion(std::vector<std::string> channels, std::int64_t num_frames, double fps = 60) {
    Motion out{MotionSpace::arkit, std::move(channels), fps, {}};
    Rng rng(5);
    for (std::int64_t i = 0; i < num_frames * out.num_channels(); ++i)
      out.values.push_back(static_cast<float>(rng.uniform()));
    return out;
  }
  std::size_t num_files() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }

  fs::path folder_;
};

TEST_F(MotionFile, EveryFormatReadsBackWhatItWrote) {
  const Bytes face = *write_glb(tiny_character());
  // What the tiny face can show, so that .glb loses nothing.
  const Motion made = motion({"eyeLookUpLeft", "jawOpen", "mouthClose"}, 130);
  for (const auto extension : motion_extensions()) {
    const fs::path path = folder_ / ("take" + std::string(extension));
    const auto status =
        write_motion(path, made, {.character_glb = face, .audio_name = "voice.wav", .glb = {}});
    ASSERT_TRUE(status) << status.error().message();
    const auto read = read_motion(path, {.fps = extension == ".npy" ? 60.0 : 0.0});
    ASSERT_TRUE(read) << read.error().message();
    EXPECT_EQ(read->fps, 60);
    ASSERT_EQ(read->num_frames(), 130) << extension;
    for (std::int64_t n = 0; n < 130; ++n)
      for (std::size_t c = 0; c < 3; ++c) {
        const auto column = extension == ".npy" ? c : static_cast<std::size_t>(*read->find(made.channels[c]));
        ASSERT_NEAR(read->frame(n)[column], made.frame(n)[c], 1e-8) << extension;
      }
  }
  EXPECT_EQ(num_files(), motion_extensions().size());
}

TEST_F(MotionFile, TextFilesMayKeepTheirDataBeside) {
  Glb glb = open_glb(*animate_glb(*write_glb(tiny_character()), motion({"jawOpen"}, 3), ""));
  glb.json["buffers"][0]["uri"] = "my%20take.bin";
  ASSERT_TRUE(write_file(folder_ / "take.gltf", glb.json.dump()));
  ASSERT_TRUE(write_file(folder_ / "my take.bin", std::span<const std::byte>(glb.bin)));
  const auto read = read_motion(folder_ / "take.gltf");
  ASSERT_TRUE(read) << read.error().message();
  EXPECT_EQ(read->num_frames(), 3);
  fs::remove(folder_ / "my take.bin");
  EXPECT_EQ(read_motion(folder_ / "take.gltf").error().code, Errc::input);
}

TEST_F(MotionFile, LongMotionGoesThroughInBlocks) {
  const Motion made = motion(arkit_and_head_channels(), 3000);  // 1.7 MB of CSV
  ASSERT_TRUE(write_motion(folder_ / "long.csv", made));
  const auto read = read_motion(folder_ / "long.csv");
  ASSERT_TRUE(read) << read.error().message();
  ASSERT_EQ(read->values.size(), made.values.size());
  EXPECT_NEAR(read->values.back(), made.values.back(), 1e-5);
}

TEST_F(MotionFile, NamesOfArrayColumnsFollowFromTheWidth) {
  const auto read = [&](std::vector<std::int64_t> shape) {
    std::size_t count = 1;
    for (const auto size : shape) count *= static_cast<std::size_t>(size);
    const fs::path path = folder_ / "array.npy";
    EXPECT_TRUE(write_file(path, std::span<const std::byte>(write_npy({shape, std::vector<float>(count)}))));
    return read_motion(path, {.fps = 30});
  };
  EXPECT_EQ(read({2, 52})->channels, arkit_order(ArkitOrder::apple));
  EXPECT_EQ(read({2, 55})->channels, arkit_and_head_channels());
  EXPECT_EQ(read({2, 51})->channels[0], "browDownLeft");
  EXPECT_FALSE(read({2, 51})->find("tongueOut"));
  EXPECT_EQ(read({2, 32})->channels[0], "jawForward");
  EXPECT_EQ(read({2, 52})->fps, 30);
  EXPECT_EQ(read({4, 100, 3})->space, MotionSpace::vertices);
  EXPECT_EQ(read({4, 100, 3})->num_frames(), 4);
  EXPECT_TRUE(read({4, 100, 3})->channels.empty());
  EXPECT_EQ(read({4, 100, 3})->topology, (Topology{"", 100}));
  EXPECT_EQ(read({1, 5023 * 3})->topology.name, "flame");
  EXPECT_EQ(read({4, 192})->channels[166], "cn_jaw.0");
  EXPECT_EQ(read({4, 60, 3})->topology, (Topology{"", 60})) << "three coordinates tell it";
  EXPECT_EQ(read({4, 17, 3})->space, MotionSpace::vertices) << "not 51 coefficients";
  EXPECT_EQ(read({4, 180})->space, MotionSpace::rig);
  EXPECT_EQ(read({4, 7})->space, MotionSpace::rig);
  EXPECT_EQ(read({4, 7})->channels[6], "channel_6");
  EXPECT_EQ(read({4})->num_channels(), 1);
  EXPECT_EQ(read({0, 52})->num_frames(), 0);
  EXPECT_EQ(read({4, 0}).error().code, Errc::incompatible);
  EXPECT_EQ(read({}).error().code, Errc::incompatible);
  EXPECT_EQ(read({0, 1000000000}).error().code, Errc::incompatible);
  EXPECT_EQ(read({0, 1ll << 40, 1ll << 40}).error().code, Errc::incompatible);
}

TEST_F(MotionFile, ErrorsNameTheFile) {
  const auto unknown = write_motion(folder_ / "a.fbx", motion({"jawOpen"}, 1));
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().code, Errc::usage);
  EXPECT_NE(unknown.error().message().find(".csv, .glb, .json, .npy"), std::string::npos);
  EXPECT_EQ(read_motion(folder_ / "a.fbx").error().code, Errc::usage);
  EXPECT_EQ(read_motion(folder_ / "a.csv").error().code, Errc::input);
  EXPECT_EQ(write_motion(folder_ / "a.glb", motion({"jawOpen"}, 1)).error().code, Errc::usage);
  EXPECT_EQ(write_motion(folder_ / "no" / "a.csv", motion({"jawOpen"}, 1)).error().code, Errc::failed);
  ASSERT_TRUE(write_file(folder_ / "b.JSON", std::string_view("{]")));
  const auto broken = read_motion(folder_ / "b.JSON");
  ASSERT_FALSE(broken);
  EXPECT_NE(broken.error().message().find("b.JSON"), std::string::npos);
  EXPECT_NE(broken.error().message().find("at byte 2"), std::string::npos);
}

TEST_F(MotionFile, NothingIsLeftBehindWhenWritingFails) {
  Motion broken = motion({"jawOpen"}, 3);
  broken.values[2] = NAN;
  const Bytes face = *write_glb(tiny_character());
  for (const auto extension : motion_extensions()) {
    const auto status = write_motion(folder_ / ("x" + std::string(extension)), broken,
                                     {.character_glb = face, .audio_name = {}, .glb = {}});
    EXPECT_FALSE(status) << extension;
  }
  EXPECT_EQ(num_files(), 0u);
  // A device that is always full.
  if (fs::exists("/dev/full")) {
    const auto status = write_motion("/dev/full/x.csv", motion({"jawOpen"}, 3));
    EXPECT_EQ(status.error().code, Errc::failed);
  }
}

TEST_F(MotionFile, WarningsComeThrough) {
  const auto status = write_motion(folder_ / "a.csv", motion({"jawOpen", "wink"}, 1));
  ASSERT_TRUE(status);
  EXPECT_EQ(status.warnings.size(), 1u);
  const Bytes face = *write_glb(tiny_character());
  const auto glb = write_motion(folder_ / "a.glb", motion({"jawOpen", "wink"}, 1),
                                {.character_glb = face, .audio_name = {}, .glb = {}});
  ASSERT_TRUE(glb);
  EXPECT_FALSE(glb.warnings.empty());
}

}  // namespace
}  // namespace mien
