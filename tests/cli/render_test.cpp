// render, inspect and evaluate.
#include <gmock/gmock.h>

#include <cmath>

#include "mien/core/arkit.h"
#include "mien/io/motion_file.h"
#include "mien/render/png.h"
#include "program.h"
#include "small_face_model.h"
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

TEST_F(ProgramTest, SeveralMotionsHaveARowEach) {
  ASSERT_EQ(animate({"-o", "a.json"}).exit_code, 0);
  ASSERT_EQ(animate({"--emotion", "happy:3", "-o", "b.json"}).exit_code, 0);
  const auto sheet = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words = {"render", "a.json", "b.json", "-o", "s.png", "--size", "40"};
    words.insert(words.end(), more.begin(), more.end());
    const auto run = mien(words);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    const auto picture = read_png(in_folder("s.png"));
    return picture ? std::pair(picture->width(), picture->height()) : std::pair(0, 0);
  };
  EXPECT_EQ(sheet({"--times", "0.5,1,1.5"}), std::pair(6 + 12 + 3 * 42, 12 + 2 * 42));
  EXPECT_EQ(sheet({}), std::pair(6 + 12 + 6 * 42, 12 + 2 * 42));
  EXPECT_EQ(sheet({"--times", "0.5"}), std::pair(80, 40)) << "at one instant, side by side";
  EXPECT_EQ(sheet({"--times", "0.5", "--columns", "1"}), std::pair(40, 80));
  const auto film = mien({"render", "a.json", "b.json", "a.json", "--columns", "2", "-o", "frames/", "--size",
                          "32", "--fps", "2"});
  ASSERT_EQ(film.exit_code, 0) << film.err;
  const auto frame = read_png(in_folder("frames") / "frame_000001.png");
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->width(), 64);
  EXPECT_EQ(frame->height(), 64);
}

TEST_F(ProgramTest, EmotionsOfOneRecordingAreShownTogether) {
  const auto run = animate({"--emotions", "neutral,happy:3", "--times", "0.5,1.5", "--size", "48", "-o",
                            "e.png", "-o", "e.mp4", "--seed", "4"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_GT(bytes_of("e.mp4").size(), 1000u);
  for (const char* emotion : {"neutral", "happy:3"})
    ASSERT_EQ(animate({"--emotion", emotion, "--seed", "4", "-o", std::string(emotion) + ".json"}).exit_code,
              0);
  ASSERT_EQ(
      mien({"render", "neutral.json", "happy:3.json", "--times", "0.5,1.5", "--size", "48", "-o", "r.png"})
          .exit_code,
      0);
  EXPECT_EQ(bytes_of("e.png"), bytes_of("r.png"));
  ASSERT_EQ(animate({"--emotions", "all:2", "--times", "1", "--size", "32", "-o", "all.png"}).exit_code, 0);
  const auto all = read_png(in_folder("all.png"));
  ASSERT_TRUE(all);
  EXPECT_EQ(all->width(), 4 * 32);
  EXPECT_EQ(all->height(), 2 * 32);

  const auto refusal = [&](const std::vector<std::string>& more) {
    const auto refused = animate(more);
    EXPECT_EQ(refused.exit_code, 2) << refused.err;
    return refused.err;
  };
  EXPECT_THAT(refusal({"--emotions", "happy,hapy", "-o", "a.png"}), HasSubstr("surprised"));
  EXPECT_THAT(refusal({"--emotions", "happy,", "-o", "a.png"}), HasSubstr("''"));
  EXPECT_THAT(refusal({"--emotions", "happy:9", "-o", "a.png"}), HasSubstr("--emotion"));
  EXPECT_THAT(refusal({"--emotions", "all", "-o", "a.csv"}), HasSubstr("holds one emotion"));
  EXPECT_THAT(refusal({"--emotions", "all", "--emotion", "sad", "-o", "a.png"}), HasSubstr("several"));
  EXPECT_THAT(refusal({"--emotions", "all", "--takes", "2", "-o", "a.png"}), HasSubstr("--takes"));
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

// A perfect model, and a perfect regression, which does not vary.
TEST_F(ProgramTest, EvaluateKnowsWhatCanBeReached) {
  std::map<std::string, std::map<std::string, double>> values;
  for (const std::string reference : {"truth", "mean"}) {
    const auto run =
        mien({"evaluate", "corpus", project_path("tests/data/corpus_fixture").string(), "--model", reference,
              "--takes", "4", "--true-takes", "4", "--draws", "0", "--max-items", "4", "--json"});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    const auto table = nlohmann::json::parse(run.out);
    for (const auto& row : table.at("rows"))
      if (const auto& value = row.at("values").at(0).at("value"); value.is_number())
        values[reference][row.at("name")] = value.get<double>();
  }
  EXPECT_GT(values["truth"]["r, all emotions"], 0.9);
  EXPECT_GT(values["mean"]["r, all emotions"], values["truth"]["r, all emotions"]);
  EXPECT_NEAR(values["truth"]["D, lower"], 1, 0.35);
  EXPECT_EQ(values["mean"]["D, lower"], 0);
}

// A published system on the same benchmark; what was compared goes to the other evaluations.
TEST_F(ProgramTest, EvaluateMeasuresPublishedModelsAndKeepsWhatItCompared) {
  const auto corpus = project_path("tests/data/corpus_fixture").string();
  ModelFile beat = face_description(Architecture::facediffuser_beat);
  beat.output = {.space = "arkit", .channels = 52, .fps = 30, .topology = ""};
  write_face_model(in_folder("beat.safetensors"), beat,
                   facediffuser::BeatDenoiser<Tensor>({.variant = facediffuser::Variant::beat,
                                                       .num_channels = 52,
                                                       .latent = 6,
                                                       .hidden = 6,
                                                       .num_steps = 12,
                                                       .condition = 32}));
  write_face_model(in_folder("mesh.safetensors"), face_description(Architecture::facediffuser_v),
                   facediffuser::VertexDenoiser<Tensor>(small_mesh_sizes()));
  std::vector<std::string> words = {
      "evaluate", "corpus", corpus,        "--model", "beat.safetensors", "--takes", "2", "--true-takes", "2",
      "--draws",  "0",      "--max-items", "2",       "--keep",           "kept"};
  const auto run = mien(words);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("closure F1"));
  EXPECT_EQ(mien(words).exit_code, 2) << "the folder is in use";
  for (const char* name : {"truth/sentence01.csv", "truth/sentence02.csv", "takes/sentence01-1.csv",
                           "takes/sentence02-2.csv", "wav/sentence02.wav"})
    EXPECT_TRUE(std::filesystem::exists(in_folder("kept") / name)) << name;
  const auto truth = read_motion(in_folder("kept/truth/sentence01.csv")),
             take = read_motion(in_folder("kept/takes/sentence01-1.csv"));
  ASSERT_TRUE(truth && take);
  EXPECT_EQ(take->num_frames(), truth->num_frames());

  const auto faces =
      mien({"evaluate", "takes", "kept/takes", "kept/truth", "--character", "default", "--json"});
  ASSERT_EQ(faces.exit_code, 0) << faces.err;
  const auto table = nlohmann::json::parse(faces.out);
  std::map<std::string, double> values;
  for (const auto& row : table.at("rows")) values[row.at("name")] = row.at("values").at(0).at("value");
  EXPECT_GT(values.at("MVE"), 0.01) << "millimetres";
  EXPECT_GT(values.at("LVE"), values.at("CE")) << "the nearest of two takes is nearer than the first";
  const auto same = mien({"evaluate", "takes", "kept/truth", "kept/truth", "--character", "default"});
  ASSERT_EQ(same.exit_code, 0) << same.err;
  EXPECT_THAT(same.out, testing::ContainsRegex("MVE +0.0000"));
  EXPECT_EQ(mien({"evaluate", "takes", "kept/takes", "kept/truth"}).exit_code, 2) << "coefficients alone";

  for (const std::string folder : {"takes", "truth"}) {  // few frames: the search for the surface takes long
    std::string text(
        as_text(bytes_of("kept/" + folder + "/sentence01" + (folder == "takes" ? "-1" : "") + ".csv")));
    for (std::size_t line = 0, at = 0; line < 9 && at != std::string::npos; ++line)
      if (at = text.find('\n', at + 1); line == 8 && at != std::string::npos) text.resize(at + 1);
    std::filesystem::create_directories(in_folder("few/" + folder));
    write("few/" + folder + "/sentence01.csv", text);
  }
  const auto surfaces =
      mien({"evaluate", "takes", "few/takes", "few/truth", "--character", "default", "--surface", "--json"});
  ASSERT_EQ(surfaces.exit_code, 0) << surfaces.err;
  const auto few = nlohmann::json::parse(surfaces.out);
  for (const auto& row : few.at("rows"))
    if (const auto& value = row.at("values").at(0).at("value"); value.is_number())
      values[row.at("name")] = value.get<double>();
  EXPECT_GT(values.at("surface distance"), 0.001);
  EXPECT_LT(values.at("surface distance"), values.at("MVE"))
      << "the surface is nearer than the vertex's place";

  const auto controls = mien({"evaluate", "controls", "kept/takes", "kept/truth", "--json"});
  ASSERT_EQ(controls.exit_code, 0) << controls.err;
  EXPECT_THAT(controls.out, HasSubstr("4 sequences")) << "two takes of two items";
  const auto control_table = nlohmann::json::parse(controls.out);
  double by_hand = 0;  // of BEAT's 51 by name, at BEAT's rate
  for (const std::string pair : {"sentence01-1", "sentence01-2", "sentence02-1", "sentence02-2"}) {
    const auto p = read_motion(in_folder("kept/takes/" + pair + ".csv"), {.fps = 30}),
               g = read_motion(in_folder("kept/truth/" + pair.substr(0, 10) + ".csv"), {.fps = 30});
    ASSERT_TRUE(p && g);
    double frames = 0;
    for (std::int64_t n = 0; n < g->num_frames(); ++n) {
      double squares = 0;
      for (const auto& name : arkit_order(ArkitOrder::beat)) {
        const auto at = static_cast<std::size_t>(*g->find(name));
        squares += std::pow(static_cast<double>(p->frame(n)[at]) - static_cast<double>(g->frame(n)[at]), 2);
      }
      frames += std::sqrt(squares);
    }
    by_hand += frames / static_cast<double>(g->num_frames()) / 4;
  }
  EXPECT_NEAR(control_table.at("rows").at(0).at("values").at(0).at("value").get<double>(), by_hand, 1e-7);

  words[4] = "mesh.safetensors";
  words.back() = "other";
  const auto mesh = mien(words);
  EXPECT_EQ(mesh.exit_code, 4) << mesh.err;
  EXPECT_THAT(mesh.err, HasSubstr("vertices"));
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
