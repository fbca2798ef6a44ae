// mien-train on a synthetic corpus, for the systems whose published data are something else: meshes, BEAT's
// coefficients, BlendVOCA's. The systems with emotions are in emotional_program_test.cpp.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "mien/base/file.h"
#include "mien/core/arkit.h"
#include "mien/models/face_model.h"
#include "mien/models/said/said_model.h"
#include "mien/models/said/vae.h"
#include "running_program.h"
#include "small_encoder.h"
#include "test_folder.h"
#include "test_paths.h"

namespace mien {
namespace {

namespace fs = std::filesystem;

class CorpusProgram : public testing::Test {
 protected:
  void SetUp() override { write_encoder(folder_ / "encoder.safetensors"); }
  /// Trains, from nothing, what fits a test. @return the exit code
  int train(const std::string& system, const std::string& model, const std::string& training,
            const std::string& run = "encoder = \"encoder.safetensors\"\n") {
    fs::remove_all(folder_ / "work");
    const std::string text =
        "[run]\nsystem = \"" + system + "\"\ndata = \"" + corpus_ + "\"\nvalidation = \"" + corpus_ +
        "\"\ntakes = 2\noutput = \"model.safetensors\"\nwork_folder = \"work\"\n" + "threads = 1\n" + run +
        "[model]\n" + model + "[training]\nlearning_rate = 1e-3\n" + training;
    if (!write_file(folder_ / "config.toml", std::string_view(text))) return -1;
    RunningProgram program(built_path("bin/mien-train").string(), {"config.toml"}, folder_);
    const int code = program.wait();
    said_ = program.err();
    return code;
  }
  [[nodiscard]] static AudioClip half_a_second() {
    AudioClip clip{{}, 16000};
    for (int i = 0; i < 8000; ++i)
      clip.samples.push_back(static_cast<float>(0.3 * std::sin(0.1 * i) * std::sin(0.002 * i)));
    return clip;
  }
  [[nodiscard]] Result<Motion> animated(const FaceModel& model, const std::string& style,
                                        const std::string& emotion = "") const {
    FaceOptions options = published_options(model.description());
    options.style = style;
    options.emotion = emotion;
    Progress progress;
    MIEN_TRY(const auto takes, animate(model, half_a_second(), options, 1, 1, progress));
    return takes.front();
  }

  TestFolder owned_;
  fs::path folder_ = owned_.path();
  const std::string corpus_ = project_path("tests/data/corpus_fixture").string();
  std::string said_;
};

// All 52 curves take the place of vertices; speakers are the identities.
TEST_F(CorpusProgram, SystemsOfMeshesLearnCurves) {
  for (const std::string system : {"facexhubert", "facediffuser_v"}) {
    SCOPED_TRACE(system);
    const bool diffuses = system == "facediffuser_v";
    ASSERT_EQ(train(system,
                    diffuses ? "latent = 8\nhidden = 8\nlayers = 1\ndiffusion_steps = 20\n"
                             : "hidden = 8\nlayers = 1\n",
                    "epochs = 1\n"),
              0)
        << said_;
    EXPECT_NE(said_.find("epoch 0: validation loss"), std::string::npos) << said_;
    const auto model = FaceModel::load(folder_ / "model.safetensors");
    ASSERT_TRUE(model) << model.error().message();
    const ModelFile& d = model->description();
    EXPECT_EQ(d.output.space, "arkit");
    EXPECT_EQ(d.output.fps, 25);
    EXPECT_EQ(d.subjects, (std::vector<std::string>{"S00", "S01", "S02", "S03", "S08", "S09", "S10"}));
    EXPECT_EQ(d.training_set, "{\"layout\": \"corpus\"}");
    const auto motion = animated(*model, "S09");
    ASSERT_TRUE(motion) << motion.error().message();
    EXPECT_TRUE(std::ranges::equal(motion->channels, arkit_names()));
    EXPECT_NE(animated(*model, "S01")->values, motion->values) << "the speaker does nothing";
    if (!diffuses) {
      EXPECT_NE(animated(*model, "S09", "neutral")->values, motion->values) << "the emotion does nothing";
    }
  }
}

TEST_F(CorpusProgram, FaceDiffuserOfCoefficientsLearnsAll52At30Frames) {
  ASSERT_EQ(train("facediffuser_beat", "latent = 8\nhidden = 8\nlayers = 1\ndiffusion_steps = 20\n",
                  "epochs = 1\n"),
            0)
      << said_;
  const auto model = FaceModel::load(folder_ / "model.safetensors");
  ASSERT_TRUE(model) << model.error().message();
  EXPECT_EQ(model->description().output.fps, 30);
  EXPECT_TRUE(model->description().subjects.empty());
  EXPECT_TRUE(std::ranges::equal(model->empty_motion().channels, arkit_names()));
  EXPECT_TRUE(animated(*model, ""));
}

TEST_F(CorpusProgram, SaidLearnsIts32OfTheCurves) {
  ASSERT_EQ(train("said", "width = 32\ndiffusion_steps = 20\n",
                  "epochs = 1\nbatch = 8\nshortest_window = 24\nwarm_up_epochs = 0\nvalidate_every = "
                  "1\nvalidation_passes = 1\n"),
            0)
      << said_;
  EXPECT_NE(said_.find("24 sequences to learn from, 12 to validate"), std::string::npos) << said_;
  EXPECT_NE(said_.find("epoch 0: validation loss"), std::string::npos) << said_;
  const auto model = SaidModel::load(folder_ / "model.safetensors");
  ASSERT_TRUE(model) << model.error().message();
  EXPECT_EQ(model->description().training_set, "{\"layout\": \"corpus\"}");
  SaidOptions options;
  options.sampling.num_steps = 5;
  Progress progress;
  EXPECT_TRUE(animate(*model, half_a_second(), options, 1, 1, progress));

  // Without sound; the deviations of the coefficients that do not move are 0, so nothing is divided by them.
  ASSERT_EQ(
      train("said_vae", "", "epochs = 1\nbatch = 8\ndivide_by_deviation = false\nvalidate_every = 1\n", ""),
      0)
      << said_;
  EXPECT_NE(said_.find("24 sequences to learn from, 12 to validate"), std::string::npos) << said_;
  EXPECT_TRUE(said::load_vae(folder_ / "model.safetensors"));
}

TEST_F(CorpusProgram, TheFilesOfTheComparisonAreRead) {
  int count = 0;
  for (const auto& entry : fs::directory_iterator(project_path("configs/comparison"))) {
    RunningProgram program(built_path("bin/mien-train").string(), {entry.path().string(), "--quiet"},
                           folder_);
    EXPECT_EQ(program.wait(), 3) << entry.path() << program.err()
                                 << ": what is absent here is data, not a field";
    ++count;
  }
  EXPECT_EQ(count, 11);
}

TEST_F(CorpusProgram, NamesWhatCannotLearnFromIt) {
  EXPECT_EQ(train("facediffuser_damm", "latent = 8\nhidden = 8\n", "epochs = 1\n"), 4) << said_;
  EXPECT_NE(said_.find("facediffuser_beat"), std::string::npos) << said_;
  EXPECT_EQ(train("facexhubert", "hidden = 8\n", "epochs = 1\n",
                  "encoder = \"encoder.safetensors\"\nlayout = \"biwi\"\n"),
            2)
      << said_;
  EXPECT_NE(said_.find("layout"), std::string::npos) << said_;
}

}  // namespace
}  // namespace mien
