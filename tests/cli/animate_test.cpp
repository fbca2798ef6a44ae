#include <gmock/gmock.h>

#include "mien/io/motion_file.h"
#include "mien/render/png.h"
#include "program.h"
#include "test_paths.h"

namespace mien {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::MatchesRegex;

TEST_F(ProgramTest, AnimateWritesTheFaceBesideTheCallerByDefault) {
  const auto run = animate({"--seed", "7"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.out, "");
  EXPECT_THAT(run.err,
              MatchesRegex("(.*\n)?wrote speech.glb: 2.00 s of speech in [0-9.]+ s \\(real-time factor "
                           "[0-9.]+\\), seed 7\n"));
  EXPECT_THAT(files(), ElementsAre("small.safetensors", "speech.glb", "speech.wav"));
  const auto motion = read_motion(in_folder("speech.glb"));
  ASSERT_TRUE(motion) << motion.error().message();
  EXPECT_EQ(motion->num_frames(), 120);
  EXPECT_EQ(motion->num_channels(), 55);
}

TEST_F(ProgramTest, AnimateWritesEveryFormat) {
  const auto run = animate({"-o", "a.glb", "-o", "a.csv", "-o", "a.json", "-o", "a.npy"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto json = read_motion(in_folder("a.json"));
  ASSERT_TRUE(json);
  for (const char* name : {"a.glb", "a.csv", "a.npy"}) {
    const auto motion = read_motion(in_folder(name));
    ASSERT_TRUE(motion) << motion.error().message();
    ASSERT_EQ(motion->num_frames(), json->num_frames()) << name;
    const auto jaw = motion->find("jawOpen"), expected = json->find("jawOpen");
    ASSERT_TRUE(jaw && expected) << name;
    for (std::int64_t n = 0; n < json->num_frames(); ++n)
      ASSERT_NEAR(motion->frame(n)[static_cast<std::size_t>(*jaw)],
                  json->frame(n)[static_cast<std::size_t>(*expected)], 1e-6)
          << name << " frame " << n;
  }
}

TEST_F(ProgramTest, AnimateFilmsTheFace) {
  const auto run =
      animate({"-o", "a.mp4", "-o", "a.webm", "-o", "a.png", "-o", "a/", "--size", "64", "--fps", "10"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_GT(bytes_of("a.mp4").size(), 1000u);
  EXPECT_GT(bytes_of("a.webm").size(), 1000u);
  EXPECT_TRUE(read_png(in_folder("a.png")));
  EXPECT_TRUE(read_png(in_folder("a") / "frame_000019.png"));
  EXPECT_FALSE(std::filesystem::exists(in_folder("a") / "frame_000020.png"));
}

TEST_F(ProgramTest, TheNumberOfThreadsDoesNotChangeAByte) {
  for (const char* threads : {"1", "2", "7"}) {
    const std::string stem = std::string("t") + threads;
    const auto run = animate({"--takes", "3", "--threads", threads, "-o", stem + ".csv", "-o", stem + ".npy",
                              "--seed", "5", "--emotion", "happy:2"});
    ASSERT_EQ(run.exit_code, 0) << run.err;
  }
  for (const char* ending : {"-1.csv", "-2.csv", "-3.csv", "-1.npy", "-3.npy"})
    for (const char* other : {"t2", "t7"})
      EXPECT_EQ(bytes_of(std::string("t1") + ending), bytes_of(std::string(other) + ending))
          << other << ending;
  EXPECT_NE(bytes_of("t1-1.npy"), bytes_of("t1-2.npy"));
}

TEST_F(ProgramTest, TheSeedChoosesTheTake) {
  ASSERT_EQ(animate({"--seed", "1", "-o", "a.npy"}).exit_code, 0);
  ASSERT_EQ(animate({"--seed", "1", "-o", "b.npy"}).exit_code, 0);
  ASSERT_EQ(animate({"--seed", "2", "-o", "c.npy"}).exit_code, 0);
  EXPECT_EQ(bytes_of("a.npy"), bytes_of("b.npy"));
  EXPECT_NE(bytes_of("a.npy"), bytes_of("c.npy"));
}

TEST_F(ProgramTest, DirectionReachesTheFace) {
  write("mood.csv", "time,emotion,intensity,style\n0,neutral,0,S01\n1,angry,3,S02\n");
  ASSERT_EQ(animate({"-o", "plain.npy"}).exit_code, 0);
  ASSERT_EQ(animate({"-o", "angry.npy", "--emotion", "angry:2"}).exit_code, 0);
  ASSERT_EQ(animate({"-o", "styled.npy", "--style", "S05"}).exit_code, 0);
  ASSERT_EQ(animate({"-o", "curve.npy", "--emotion", "mood.csv"}).exit_code, 0);
  write("mood.json", R"([{"time":0,"emotion":"neutral","intensity":0,"style":"S01"},
                       {"time":1,"emotion":"angry","intensity":3,"style":"S02"}])");
  ASSERT_EQ(animate({"-o", "same.npy", "--emotion", "mood.json"}).exit_code, 0);
  EXPECT_EQ(bytes_of("curve.npy"), bytes_of("same.npy"));
  ASSERT_EQ(animate({"-o", "ddim.npy", "--sampler", "ddim", "--steps", "3"}).exit_code, 0);
  for (const char* name : {"angry.npy", "styled.npy", "curve.npy", "ddim.npy"})
    EXPECT_NE(bytes_of("plain.npy"), bytes_of(name)) << name;
}

TEST_F(ProgramTest, FpsChangesTheRateOfTheFiles) {
  ASSERT_EQ(animate({"-o", "a.json", "--fps", "25"}).exit_code, 0);
  const auto motion = read_motion(in_folder("a.json"));
  ASSERT_TRUE(motion);
  EXPECT_EQ(motion->fps, 25);
  EXPECT_EQ(motion->num_frames(), 50);
}

TEST_F(ProgramTest, JsonTellsTheStoryInEvents) {
  const auto good = animate({"-o", "a.csv", "--json", "--seed", "9"});
  ASSERT_EQ(good.exit_code, 0);
  const auto events = good.events();
  ASSERT_GE(events.size(), 2u);
  EXPECT_EQ(events.front()["type"], "start");
  EXPECT_EQ(events.front()["command"], "animate");
  EXPECT_EQ(events.back()["type"], "success");
  EXPECT_EQ(events.back()["outputs"][0], "a.csv");
  EXPECT_EQ(events.back()["seed"], 9);
  EXPECT_NEAR(events.back()["speech_seconds"], 2, 1e-9);

  const auto bad = mien({"animate", "absent.wav", "--model", "small.safetensors", "--json"});
  EXPECT_EQ(bad.exit_code, 3);
  ASSERT_FALSE(bad.events().empty());
  EXPECT_EQ(bad.events().back()["type"], "failure");
  EXPECT_EQ(bad.events().back()["exit_code"], 3);
  EXPECT_THAT(bad.events().back()["what"], HasSubstr("absent.wav"));
}

TEST_F(ProgramTest, QuietSaysNothing) {
  const auto run = animate({"-o", "a.csv", "--quiet"});
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_EQ(run.err, "");
}

TEST_F(ProgramTest, ModelAndHeadAreFoundInTheShareFolder) {
  std::filesystem::create_directory(in_folder("share"));
  std::filesystem::copy(in_folder("small.safetensors"), in_folder("share") / "default.safetensors");
  std::filesystem::copy(built_path("share/mien/head.glb"), in_folder("share") / "head.glb");
  EXPECT_EQ(mien({"animate", "speech.wav"}, "export MIEN_SHARE=share;").exit_code, 0);
  std::filesystem::remove(in_folder("share") / "head.glb");
  const auto run = mien({"animate", "speech.wav"}, "export MIEN_SHARE=share;");
  EXPECT_EQ(run.exit_code, 3);
  EXPECT_THAT(run.err, HasSubstr("head.glb"));
  EXPECT_THAT(run.err, HasSubstr("--character"));
}

}  // namespace
}  // namespace mien
