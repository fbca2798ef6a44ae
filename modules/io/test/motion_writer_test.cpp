#include "mien/io/motion_writer.h"

#include <gmock/gmock.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>

#include "io_test_support.h"
#include "mien/base/file.h"
#include "mien/core/arkit.h"
#include "mien/core/flame_parameters.h"
#include "mien/io/motion_file.h"

namespace mien {
namespace {

namespace fs = std::filesystem;
constexpr const char* kNames[] = {"a.csv", "a.metahuman.csv", "a.said.csv", "a.json", "a.npy"};

class MotionWriterTest : public testing::Test {
 protected:
  MotionWriterTest() {
    std::string name = (fs::path(testing::TempDir()) / "mien_writer_XXXXXX").string();
    folder_ = ::mkdtemp(name.data());
  }
  ~MotionWriterTest() override { fs::remove_all(folder_); }
  static Motion motion(std::int64_t num_frames) {
    Motion m{MotionSpace::arkit, arkit_order(ArkitOrder::beat), 30, {}};
    for (std::int64_t i = 0; i < num_frames * m.num_channels(); ++i)
      m.values.push_back(static_cast<float>(std::sin(static_cast<double>(i) * 0.37)));
    return m;
  }
  fs::path folder_;
};

TEST_F(MotionWriterTest, GivesTheSameBytesForAnyCut) {
  for (const char* name : kNames)
    for (const std::int64_t num_frames : {0, 1, 101}) {
      const Motion all = motion(num_frames);
      ASSERT_TRUE(write_motion(folder_ / name, all));
      const auto whole = read_file(folder_ / name);
      ASSERT_TRUE(whole);
      for (const std::size_t piece : {1u, 7u}) {
        auto writer = MotionWriter::create(folder_ / name, all);
        ASSERT_TRUE(writer);
        const std::size_t step = piece * all.channels.size();
        for (std::size_t at = 0; at < all.values.size(); at += step)
          ASSERT_TRUE(writer->add(std::span(all.values).subspan(at, std::min(step, all.values.size() - at))));
        ASSERT_TRUE(writer->add({})) << "no frames";
        ASSERT_TRUE(writer->finish());
        const auto cut = read_file(folder_ / name);
        ASSERT_TRUE(cut);
        EXPECT_TRUE(*cut == *whole) << name << ", " << num_frames << " frames, " << piece << " at a time";
      }
      const auto read = read_motion(folder_ / name);
      if (num_frames == 0) continue;  // which some readers call a mistake
      ASSERT_TRUE(read) << read.error().message();
      EXPECT_EQ(read->num_frames(), num_frames);
    }
}

// The header of the array states the number of frames on its second axis.
TEST_F(MotionWriterTest, WritesFlameParametersWhileTheyArrive) {
  Motion all{MotionSpace::flame, flame_channels(0, 2), 25, {}};
  for (int i = 0; i < 1200 * 5; ++i) all.values.push_back(static_cast<float>(i) / 7);
  for (const char* name : {"f.csv", "f.json", "f.npy"}) {
    ASSERT_TRUE(write_motion(folder_ / name, all));
    const auto whole = read_file(folder_ / name);
    auto writer = MotionWriter::create(folder_ / name, all);
    ASSERT_TRUE(writer);
    for (std::int64_t n = 0; n < all.num_frames(); ++n) ASSERT_TRUE(writer->add(all.frame(n)));
    ASSERT_TRUE(writer->finish());
    const auto one_by_one = read_file(folder_ / name);
    ASSERT_TRUE(whole && one_by_one);
    EXPECT_TRUE(*one_by_one == *whole) << name;
    const auto read = read_motion(folder_ / name);
    ASSERT_TRUE(read) << read.error().message();
    EXPECT_EQ(read->space, MotionSpace::flame);
    ASSERT_EQ(read->num_frames(), 1200);
    EXPECT_EQ(read->frame(1199)[static_cast<std::size_t>(*read->find("jaw_z"))], all.values.back()) << name;
  }
  EXPECT_EQ(MotionWriter::create(folder_ / "f.said.csv", all).error().code, Errc::incompatible);
}

TEST_F(MotionWriterTest, TakesFormatsThatNeedOneFrameAtATime) {
  for (const char* name : kNames) EXPECT_TRUE(MotionWriter::can_write(name));
  EXPECT_TRUE(MotionWriter::can_write("A.CSV"));
  for (const char* name : {"a.glb", "a.mp4", "a", "csv"}) EXPECT_FALSE(MotionWriter::can_write(name));
  EXPECT_THROW((void)MotionWriter::create("a.glb", motion(0)), std::logic_error);
}

TEST_F(MotionWriterTest, ErrorsLeaveNothing) {
  for (const char* name : kNames) {
    auto writer = MotionWriter::create(folder_ / name, motion(0));
    ASSERT_TRUE(writer);
    Motion broken = motion(3);
    ASSERT_TRUE(writer->add(broken.values));
    broken.values[static_cast<std::size_t>(broken.num_channels()) + 2] = NAN;
    const Status status = writer->add(broken.values);
    ASSERT_FALSE(status);
    EXPECT_THAT(status.error().message(), testing::HasSubstr("browInnerUp' is not finite at frame 4"));
  }
  Motion rate = motion(0), rig = motion(0);
  rate.fps = 0;
  rig.space = MotionSpace::rig;
  EXPECT_EQ(MotionWriter::create(folder_ / "a.npy", rate).error().code, Errc::failed);
  EXPECT_EQ(MotionWriter::create(folder_ / "a.csv", rig).error().code, Errc::incompatible);
  EXPECT_EQ(MotionWriter::create(folder_ / "no" / "a.csv", motion(0)).error().code, Errc::failed);
  EXPECT_TRUE(fs::is_empty(folder_));
}

// A limit on the size of files stands for a full disk.
TEST_F(MotionWriterTest, AFullDiskIsSaid) {
  rlimit usual;
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &usual), 0);
  const auto signal = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{100'000, usual.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  const Motion frames = motion(300);
  for (const char* name : kNames) {
    auto writer = MotionWriter::create(folder_ / name, frames);
    ASSERT_TRUE(writer);
    Status status = Done{};
    for (int i = 0; i < 20 && status; ++i) status = writer->add(frames.values);
    ASSERT_FALSE(status) << name;
    EXPECT_EQ(status.error().code, Errc::failed);
    EXPECT_THAT(status.error().message(), testing::HasSubstr("writing failed"));
  }
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &usual), 0);
  std::signal(SIGXFSZ, signal);
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(MotionWriterTest, WritesVertices) {
  const Motion all = vertex_motion({"tri", 100}, 25, std::vector<float>(600, 0.5f));
  auto writer = MotionWriter::create(folder_ / "a.npy", all);
  ASSERT_TRUE(writer);
  for (std::int64_t n = 0; n < 2; ++n) ASSERT_TRUE(writer->add(all.frame(n)));
  ASSERT_TRUE(writer->finish());
  const auto read = read_motion(folder_ / "a.npy");
  ASSERT_TRUE(read);
  EXPECT_EQ(read->values, all.values);
  EXPECT_EQ(read->space, MotionSpace::vertices);
}

}  // namespace
}  // namespace mien
