// render, inspect and evaluate.
#include <gmock/gmock.h>

#include "mien/render/png.h"
#include "program.h"
#include "test_paths.h"

namespace mien {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

TEST_F(ProgramTest, RenderDrawsWhatAnimateWrote) {
  ASSERT_EQ(animate({"-o", "a.glb", "-o", "a.csv"}).exit_code, 0);
  EXPECT_EQ(mien({"render", "a.csv", "--audio", "speech.wav", "-o", "a.mp4", "--size", "64", "--fps", "10"})
                .exit_code,
            0);
  EXPECT_GT(bytes_of("a.mp4").size(), 1000u);
  EXPECT_EQ(mien({"render", "a.glb", "-o", "frames/", "--size", "32x48", "--fps", "2"}).exit_code, 0);
  const auto frame = read_png(in_folder("frames") / "frame_000003.png");
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->width(), 32);
  EXPECT_EQ(frame->height(), 48);
  const auto sheet = mien({"render", "a.csv", "-o", "s.png", "--size", "40", "--times", "0.5,1,1.5",
                           "--columns", "3", "--view", "mouth"});
  ASSERT_EQ(sheet.exit_code, 0) << sheet.err;
  const auto picture = read_png(in_folder("s.png"));
  ASSERT_TRUE(picture);
  EXPECT_GE(picture->width(), 120);
  EXPECT_LT(picture->height(), 60);
}

TEST_F(ProgramTest, InspectKnowsEveryKind) {
  ASSERT_EQ(animate({"-o", "a.csv", "-o", "a.glb"}).exit_code, 0);
  const auto facts = [&](const std::string& file) {
    const auto run = mien({"inspect", file, "--json"});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return nlohmann::json::parse(run.out, nullptr, false);
  };
  const auto sound = facts("speech.wav");
  EXPECT_EQ(sound["kind"], "audio");
  EXPECT_NEAR(sound["seconds"], 2, 1e-6);
  const auto motion = facts("a.csv");
  EXPECT_EQ(motion["kind"], "motion");
  EXPECT_EQ(motion["frames"], 120);
  EXPECT_EQ(motion["ranges"].size(), motion["channels"]);
  const auto character = facts("a.glb");
  EXPECT_EQ(character["kind"], "character");
  EXPECT_EQ(character["arkit_shapes"], 52);
  EXPECT_EQ(character["frames"], 120);
  const auto model = facts("small.safetensors");
  EXPECT_EQ(model["kind"], "model");
  EXPECT_EQ(model["styles"].size(), 12u);
  EXPECT_EQ(model["emotions"].size(), 8u);
  EXPECT_GT(model["parameters"], 1000);
  EXPECT_LE(model["look_ahead_ms"], 200);
  EXPECT_THAT(mien({"inspect", "speech.wav"}).out, StartsWith("kind"));
}

TEST_F(ProgramTest, EvaluateMeasuresTheFixtureCorpus) {
  const auto corpus = project_path("tests/data/corpus_fixture");
  if (!std::filesystem::exists(corpus)) GTEST_SKIP() << corpus << " is absent";
  const auto run = mien({"evaluate", "corpus", corpus.string(), "--model", "small.safetensors", "--takes",
                         "2", "--true-takes", "2", "--draws", "0", "--max-items", "2", "--json"});
  if (run.exit_code == 3) GTEST_SKIP() << "the fixture holds no sound: " << run.err;
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto table = nlohmann::json::parse(run.out, nullptr, false);
  ASSERT_TRUE(table.is_object()) << run.out;
  EXPECT_FALSE(table["rows"].empty());
}

TEST_F(ProgramTest, EvaluateShowsTheLoudnessBaselineBesidePeople) {
  const auto folder = shared_path("audio/human");
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is absent";
  const auto run = mien({"evaluate", "human", folder.string(), "--model", "small.safetensors", "--takes", "1",
                         "--draws", "0", "--only", "vctk_p225_003"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("closure F1"));
  EXPECT_THAT(run.out, HasSubstr("loudness"));
  EXPECT_THAT(run.out, HasSubstr(">= 0.62"));
  EXPECT_EQ(mien({"evaluate", "human", "nowhere", "--model", "small.safetensors"}).exit_code, 3);
}

}  // namespace
}  // namespace mien
