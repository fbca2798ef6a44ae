// mien-train on data with emotions, 3DMEAD in its true form and the corpus: ProbTalk3D in both stages and
// both forms, and the emotional FaceDiffuser, from configuration files to models that animate.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "mien/base/file.h"
#include "mien/core/flame_parameters.h"
#include "mien/io/motion_file.h"
#include "mien/models/face_model.h"
#include "mien/models/probtalk3d/conventions.h"
#include "mien/models/probtalk3d/network.h"
#include "running_program.h"
#include "small_encoder.h"
#include "small_mead.h"
#include "test_folder.h"
#include "test_paths.h"

namespace mien {
namespace {

namespace fs = std::filesystem;

class EmotionalProgram : public testing::Test {
 protected:
  void SetUp() override {
    write_encoder(folder_ / "encoder.safetensors");
    write_mead_parameters(folder_ / "mead", {"M003_001_0_0", "M003_002_1_2", "W029_003_7_0", "W029_033_0_0",
                                             "M003_025_6_1", "M032_001_0_0"});
  }
  void write_config(const std::string& name, const std::string& text) const {
    ASSERT_TRUE(write_file(folder_ / name, std::string_view(text)));
  }
  void write_prior(const std::string& data, const std::string& model = "", const std::string& training = "",
                   int epochs = 2) const {
    write_config("prior.toml",
                 "[run]\nsystem = \"probtalk3d_prior\"\ndata = \"" + data +
                     "\"\noutput = \"prior.safetensors\"\nwork_folder = \"work1\"\nthreads = 1\n" +
                     (data == "mead" ? "" : "validation = \"" + data + "\"\n") +
                     "[model]\nwidth = 16\ninner = 24\nheads = 2\nblocks = 1\ncodes = 12\ncode_width = 8\n" +
                     model + "[training]\nepochs = " + std::to_string(epochs) +
                     "\nlearning_rate = 1e-3\ncheckpoint_every = 3\n" + training);
  }
  void write_talking(const std::string& data, const std::string& training = "",
                     const std::string& run = "encoder = \"encoder.safetensors\"\n",
                     const std::string& more = "") const {
    write_config("talking.toml",
                 "[run]\nsystem = \"probtalk3d\"\ndata = \"" + data +
                     "\"\nprior = \"prior.safetensors\"\noutput = \"model.safetensors\"\nwork_folder = "
                     "\"work2\"\nthreads = 1\n" +
                     (data == "mead" ? "" : "validation = \"" + data + "\"\n") + run +
                     "[model]\nblocks = 1\n[training]\nepochs = 2\nlearning_rate = 1e-3\ncheckpoint_every = "
                     "2\n" +
                     training + more);
  }
  int run(const std::string& name, const std::vector<std::string>& arguments) {
    RunningProgram program(name, arguments, folder_);
    const int code = program.wait();
    said_ = program.err();
    return code;
  }
  int train(const std::vector<std::string>& arguments) {
    return run(built_path("bin/mien-train").string(), arguments);
  }
  void forget() {
    for (const char* old : {"work1", "work2", "prior.safetensors", "model.safetensors"})
      fs::remove_all(folder_ / old);
  }
  [[nodiscard]] std::ptrdiff_t num_steps(const char* work) const {
    const auto bytes = read_file(folder_ / work / "log.tsv");
    if (!bytes) return 0;
    const std::string_view text = as_text(*bytes);
    return std::count(text.begin(), text.end(), '\n');
  }
  /// A motion of half a second of a tone that comes and goes.
  [[nodiscard]] Result<Motion> animated(const std::string& emotion, const std::string& style = "") const {
    MIEN_TRY(const FaceModel model, FaceModel::load(folder_ / "model.safetensors"));
    AudioClip clip{{}, 16000};
    for (int i = 0; i < 8000; ++i)
      clip.samples.push_back(static_cast<float>(0.3 * std::sin(0.1 * i) * std::sin(0.002 * i)));
    FaceOptions options = published_options(model.description());
    options.emotion = emotion;
    options.style = style;
    Progress progress;
    MIEN_TRY(const auto takes, animate(model, clip, options, 1, 1, progress));
    for (const float v : takes.front().values)
      if (!std::isfinite(v)) return Error{Errc::failed, "motion", "is not finite", ""};
    return takes.front();
  }
  [[nodiscard]] ModelFile description(const char* file) const {
    const auto opened = SafetensorsFile::open(folder_ / file);
    if (!opened) throw std::runtime_error(opened.error().message());
    const auto model = read_model_file(opened->metadata());
    if (!model) throw std::runtime_error(model.error().message());
    return *model;
  }

  TestFolder owned_;
  fs::path folder_ = owned_.path();
  const std::string corpus_ = project_path("tests/data/corpus_fixture").string();
  std::string said_;
};

TEST_F(EmotionalProgram, BothStagesOfBothFormsMakeAModelFrom3DMead) {
  for (const std::string latent : {"codes", "gaussian"}) {
    SCOPED_TRACE(latent);
    forget();
    write_prior("mead", "latent = \"" + latent + "\"\n");
    ASSERT_EQ(train({"prior.toml"}), 0) << said_;
    EXPECT_NE(said_.find("5 sequences to learn from, 1 to validate"), std::string::npos) << said_;
    EXPECT_NE(said_.find("epoch 1: validation loss"), std::string::npos) << said_;
    const ModelFile prior = description("prior.safetensors");
    EXPECT_EQ(prior.architecture, Architecture::probtalk3d_prior);
    EXPECT_EQ(prior.output.space, "flame");
    EXPECT_EQ(prior.output.channels, 53);
    EXPECT_EQ(prior.sizes.at("heads"), 2);
    ASSERT_TRUE(prior.scaler);
    EXPECT_EQ(prior.scaler->scale, probtalk3d::published_scaler(53).scale);
    EXPECT_TRUE(prior.subjects.empty());

    write_talking("mead");
    ASSERT_EQ(train({"talking.toml"}), 0) << said_;
    EXPECT_NE(said_.find("3 sequences to learn from, 2 to validate"), std::string::npos) << said_;
    const ModelFile model = description("model.safetensors");
    EXPECT_EQ(model.architecture, Architecture::probtalk3d);
    EXPECT_EQ(model.subjects, probtalk3d::published_identities());
    EXPECT_EQ(model.emotions, probtalk3d::published_emotions());
    EXPECT_EQ(model.encoder, small_encoder());
    const auto motion = animated("happy:3", "W029");
    ASSERT_TRUE(motion) << motion.error().message();
    EXPECT_EQ(motion->num_frames(), 12);
    EXPECT_EQ(motion->channels, flame_channels(0, 50));
    EXPECT_NE(animated("angry:3", "W029")->values, motion->values) << "the emotion does nothing";
  }
}

TEST_F(EmotionalProgram, Stage2LeavesThePriorAsItIs) {
  write_prior("mead");
  ASSERT_EQ(train({"prior.toml", "--quiet"}), 0) << said_;
  write_talking("mead");
  ASSERT_EQ(train({"talking.toml", "--quiet"}), 0) << said_;
  const auto prior = SafetensorsFile::open(folder_ / "prior.safetensors"),
             model = SafetensorsFile::open(folder_ / "model.safetensors"),
             encoder = SafetensorsFile::open(folder_ / "encoder.safetensors");
  ASSERT_TRUE(prior && model && encoder);
  for (const auto& t : prior->tensors())
    EXPECT_EQ(*prior->read_float(t.name), *model->read_float("motion_prior." + t.name)) << t.name;
  const std::string front = "audio_encoder.feature_extractor.conv_layers.0.conv.weight",
                    last = "audio_encoder.encoder.layers.2.feed_forward.output_dense.weight";
  EXPECT_EQ(*encoder->read_float(front), *model->read_float(front));
  EXPECT_NE(*encoder->read_float(last), *model->read_float(last));
  // A finished run has nothing left to do, and a snapshot is what it wrote.
  for (const auto& [config, file] :
       {std::pair{"prior.toml", "prior.safetensors"}, std::pair{"talking.toml", "model.safetensors"}}) {
    const auto first = read_file(folder_ / file);
    ASSERT_EQ(train({config, "--quiet"}), 0) << said_;
    EXPECT_EQ(*read_file(folder_ / file), *first);
    ASSERT_EQ(train({config, "--quiet", "--snapshot", "snapshot.safetensors"}), 0) << said_;
    EXPECT_EQ(*read_file(folder_ / "snapshot.safetensors"), *first);
  }
}

TEST_F(EmotionalProgram, StopsWhenTheValidationGetsNoBetter) {
  // Steps too small to change a number: every epoch has the same loss.
  const std::string still = "monitor = \"epoch_mean\"\npatience = 2\nkeep = \"best\"\nweight_decay = 0.0\n";
  write_prior("mead", "", still, 9);
  const auto text = *read_file(folder_ / "prior.toml");
  std::string changed(as_text(text));
  changed.replace(changed.find("1e-3"), 4, "1e-30");
  write_config("prior.toml", changed);
  ASSERT_EQ(train({"prior.toml"}), 0) << said_;
  EXPECT_NE(said_.find("no better in 2 epochs"), std::string::npos) << said_;
  EXPECT_EQ(num_steps("work1"), 3 * 5);
  EXPECT_EQ(*read_file(folder_ / "prior.safetensors"), *read_file(folder_ / "work1/best.safetensors"));
  // It stays stopped.
  ASSERT_EQ(train({"prior.toml"}), 0) << said_;
  EXPECT_EQ(num_steps("work1"), 3 * 5);

  forget();
  write_prior("mead", "", "patience = 0\nkeep = \"last\"\n", 4);
  ASSERT_EQ(train({"prior.toml", "--quiet"}), 0) << said_;
  EXPECT_EQ(num_steps("work1"), 4 * 5);
}

// With keep = "best" it is the best model so far, whatever the last checkpoint holds.
TEST_F(EmotionalProgram, ASnapshotIsWhatTheRunWouldDeliver) {
  const auto write = [&](const std::string& keep, int epochs) {
    write_prior("mead", "", "patience = 0\nkeep = \"" + keep + "\"\n", epochs);
  };
  const auto train_to = [&](const std::string& name, const std::string& work) {
    ASSERT_EQ(train({"prior.toml", "--quiet", "--work-folder", work, "-o", name}), 0) << said_;
  };
  const auto snapshot = [&] {
    return train({"prior.toml", "--quiet", "--snapshot", "snapshot.safetensors"});
  };
  const auto bytes = [&](const std::string& name) { return *read_file(folder_ / name); };
  write("best", 1);
  train_to("early.safetensors", "work3");
  write("best", 3);
  train_to("late.safetensors", "work1");
  ASSERT_EQ(snapshot(), 0) << said_;
  EXPECT_EQ(bytes("snapshot.safetensors"), bytes("late.safetensors"));
  // As if the first epoch had been the best.
  fs::copy_file(folder_ / "early.safetensors", folder_ / "work1/best.safetensors",
                fs::copy_options::overwrite_existing);
  ASSERT_EQ(snapshot(), 0) << said_;
  EXPECT_EQ(bytes("snapshot.safetensors"), bytes("early.safetensors"));
  fs::remove(folder_ / "work1/best.safetensors");
  EXPECT_EQ(snapshot(), 3) << said_;
  EXPECT_NE(said_.find("no epoch has been validated"), std::string::npos) << said_;
  write("last", 3);
  ASSERT_EQ(snapshot(), 0) << said_;
  fs::remove_all(folder_ / "work1");
  train_to("last.safetensors", "work1");
  EXPECT_EQ(bytes("snapshot.safetensors"), bytes("last.safetensors"));
}

TEST_F(EmotionalProgram, BothFormsLearnTheCorpusWithANewEncoder) {
  for (const std::string latent : {"codes", "gaussian"}) {
    SCOPED_TRACE(latent);
    forget();
    write_prior(corpus_, "latent = \"" + latent + "\"\n", "", 1);
    ASSERT_EQ(train({"prior.toml"}), 0) << said_;
    EXPECT_NE(said_.find("12 sequences to learn from, 12 to validate"), std::string::npos) << said_;
    write_talking(corpus_, "frozen = []\nepochs_of = 1\n");
    EXPECT_EQ(train({"talking.toml"}), 2) << said_;
    write_talking(corpus_, "frozen = []\n", "takes = 2\n",
                  "[encoder]\nwidth = 16\nlayers = 1\nheads = 2\ninner = 24\nconvolutions = 8\n");
    ASSERT_EQ(train({"talking.toml"}), 0) << said_;
    EXPECT_NE(said_.find("24 sequences to learn from, 12 to validate"), std::string::npos) << said_;
    const ModelFile model = description("model.safetensors");
    EXPECT_EQ(model.output.space, "arkit");
    EXPECT_FALSE(model.scaler);
    EXPECT_EQ(model.subjects, (std::vector<std::string>{"S00", "S01", "S02", "S03", "S08", "S09", "S10"}));
    EXPECT_EQ(model.encoder->hidden_size, 16);
    const auto motion = animated("surprised:2", "S08");
    ASSERT_TRUE(motion) << motion.error().message();
    EXPECT_EQ(motion->space, MotionSpace::arkit);
    EXPECT_EQ(motion->fps, 25);
    EXPECT_EQ(motion->find("jawOpen"), 17);
  }
}

TEST_F(EmotionalProgram, TheEmotionalFaceDiffuserLearnsMeshesAndTheCorpus) {
  const auto write = [&](const std::string& run, const std::string& training, const std::string& more = "") {
    write_config("diffuser.toml",
                 "[run]\nsystem = \"facediffuser_emotion\"\noutput = \"model.safetensors\"\nwork_folder = "
                 "\"work1\"\nthreads = 1\n" +
                     run +
                     "[model]\nlatent = 8\nhidden = 6\ndiffusion_steps = 120\n[training]\nepochs = 1\n" +
                     training + more);
  };
  write_mead_meshes(folder_ / "meshes", {"M003_001_0_0", "W029_002_1_2", "W029_033_0_0"});
  write("data = \"meshes\"\nencoder = \"encoder.safetensors\"\nsubjects = [\"M003\", \"W029\"]\n", "");
  ASSERT_EQ(train({"diffuser.toml"}), 0) << said_;
  EXPECT_NE(said_.find("2 sequences to learn from, 1 to validate"), std::string::npos) << said_;
  const ModelFile model = description("model.safetensors");
  EXPECT_EQ(model.architecture, Architecture::facediffuser_emotion);
  EXPECT_EQ(model.intensities, probtalk3d::published_intensities());
  EXPECT_EQ(model.diffusion->steps, 120);
  const auto mesh = animated("happy:3", "W029");
  ASSERT_TRUE(mesh) << mesh.error().message();
  EXPECT_EQ(mesh->space, MotionSpace::vertices);
  const auto file = SafetensorsFile::open(folder_ / "model.safetensors");
  EXPECT_TRUE(read_template(*file, "W029"));

  fs::remove_all(folder_ / "work1");
  write("data = \"" + corpus_ + "\"\nvalidation = \"" + corpus_ + "\"\n",
        "frozen = []\nlearning_rate = 1e-2\n",
        "[encoder]\nwidth = 16\nlayers = 1\nheads = 2\ninner = 24\nconvolutions = 8\n");
  ASSERT_EQ(train({"diffuser.toml"}), 0) << said_;
  EXPECT_NE(said_.find("12 sequences to learn from, 12 to validate"), std::string::npos) << said_;
  const auto curves = animated("happy:3", "S09");
  ASSERT_TRUE(curves) << curves.error().message();
  EXPECT_EQ(curves->num_channels(), 52);
  EXPECT_NE(animated("sad:3", "S09")->values, curves->values);
}

TEST_F(EmotionalProgram, MienAnimatesWhatItTrained) {
  if (!fs::exists(built_path("bin/mien"))) GTEST_SKIP() << "built without the program (MIEN_CLI, MIEN_FACE)";
  const std::string mien = built_path("bin/mien").string();
  write_prior("mead");
  write_talking("mead");
  for (const char* config : {"prior.toml", "talking.toml"})
    ASSERT_EQ(run(mien, {"train", config, "--quiet"}), 0) << said_;
  write_wav(folder_ / "hello.wav", 16000);
  ASSERT_EQ(run(mien, {"animate", "hello.wav", "--model", "model.safetensors", "--style", "M003", "--emotion",
                       "sad:2", "--takes", "2", "-o", "hello.npy", "--quiet"}),
            0)
      << said_;
  for (const char* take : {"hello-1.npy", "hello-2.npy"}) {
    const auto motion = read_motion(folder_ / take);
    ASSERT_TRUE(motion) << motion.error().message();
    EXPECT_EQ(motion->num_frames(), 24);
  }
  ASSERT_EQ(run(mien, {"data", "check", "mead"}), 0) << said_;
}

TEST_F(EmotionalProgram, TheFilesOfConfigsAreRead) {
  for (const char* name :
       {"probtalk3d_prior", "probtalk3d_vae_prior", "probtalk3d", "probtalk3d_prior_corpus",
        "probtalk3d_corpus", "facediffuser_emotion", "facediffuser_emotion_corpus"}) {
    const auto config = project_path("configs/" + std::string(name) + ".toml");
    EXPECT_EQ(train({config.string(), "--quiet"}), 3)
        << name << said_ << ": what is absent here is data, not a field";
  }
}

TEST_F(EmotionalProgram, NamesWhatIsWrong) {
  const auto fails = [&](const char* config, int code, const std::string& word) {
    EXPECT_EQ(train({config, "--quiet"}), code) << said_;
    EXPECT_NE(said_.find(word), std::string::npos) << said_;
  };
  write_prior("mead", "latent = \"discrete\"\n");
  fails("prior.toml", 2, "codes or gaussian");
  write_prior("mead", "", "monitor = \"mean\"\n");
  fails("prior.toml", 2, "running_mean");
  write_prior("mead", "", "patience = -1\n");
  fails("prior.toml", 2, "patience must not be negative");
  write_prior("mead", "", "jaw_weight = nan\n");
  fails("prior.toml", 2, "jaw_weight");
  write_prior("mead", "expressions = 101\n");
  fails("prior.toml", 2, "expressions");
  write_prior("elsewhere");
  fails("prior.toml", 3, "elsewhere");
  write_prior("mead");
  std::string text(as_text(*read_file(folder_ / "prior.toml")));
  write_config("odd.toml", text.replace(text.find("code_width = 8"), 14, "code_width = 5"));
  fails("odd.toml", 2, "code_width");

  write_talking("mead");
  fails("talking.toml", 3, "prior.safetensors");
  fs::copy_file(folder_ / "encoder.safetensors", folder_ / "prior.safetensors");
  fails("talking.toml", 4, "no motion prior");
  fs::remove(folder_ / "prior.safetensors");
  write_prior(corpus_, "", "", 1);
  ASSERT_EQ(train({"prior.toml", "--quiet"}), 0) << said_;
  fails("talking.toml", 4, "52 channels of the space arkit");
  write_talking("mead", "", "");
  fails("talking.toml", 2, "encoder");
  write_talking(corpus_, "", "encoder = \"encoder.safetensors\"\nsubjects = [\"S15\"]\n");
  fails("talking.toml", 4, "no clip to learn from");
  // Without a validation there is nothing to wait for.
  write_talking(corpus_);
  std::string alone(as_text(*read_file(folder_ / "talking.toml")));
  const auto at = alone.find("validation");
  alone.erase(at, alone.find('\n', at) + 1 - at);
  write_config("alone.toml", alone);
  fails("alone.toml", 4, "[run] validation");
}

}  // namespace
}  // namespace mien
