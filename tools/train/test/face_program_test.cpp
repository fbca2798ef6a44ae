// mien-train on data in the true form of each data set: from a configuration file to a model file.
#include <gtest/gtest.h>

#include <cmath>

#include "mien/base/file.h"
#include "mien/base/random.h"
#include "mien/datasets/templates.h"
#include "mien/io/npy.h"
#include "mien/models/face_model.h"
#include "mien/models/facediffuser/network.h"
#include "mien/models/facexhubert/network.h"
#include "mien/models/model_file.h"
#include "mien/models/speech_encoder/network.h"
#include "mien/nn/plain_weights.h"
#include "running_program.h"
#include "small_encoder.h"
#include "test_folder.h"
#include "test_paths.h"

namespace mien {
namespace {

namespace fs = std::filesystem;

struct DataCase {
  std::string system, layout;
  std::vector<std::string> names;
  std::int64_t width;
  int stored_frames;                  // of one second
  std::vector<std::string> subjects;  // in [run], as TOML
  std::string model;
};

void write_data(const fs::path& folder, const DataCase& c) {
  Templates templates;
  for (const auto& name : c.names) {
    write_wav(folder / "wav" / (name + ".wav"), 16000);
    NpyArray array{{c.stored_frames, c.width}, {}};
    for (std::int64_t i = 0; i < c.stored_frames * c.width; ++i)
      array.values.push_back(static_cast<float>(0.3 * std::sin(0.01 * static_cast<double>(i))));
    fs::create_directories(folder / "vertices_npy");
    ASSERT_TRUE(
        write_file(folder / "vertices_npy" / (name + ".npy"), std::span<const std::byte>(write_npy(array))));
    templates[name.substr(0, name.rfind('_'))].assign(static_cast<std::size_t>(c.width), 0.1f);
  }
  if (!c.subjects.empty()) {
    ASSERT_TRUE(write_templates(folder / "templates.safetensors", templates));
  }
}

class FaceProgram : public testing::Test {
 protected:
  void SetUp() override { write_encoder(folder_ / "encoder.safetensors"); }

  /// Exit code of mien-train in the folder; said_ is what it said.
  int train(std::vector<std::string> arguments) {
    arguments.push_back("--quiet");
    RunningProgram program(built_path("bin/mien-train").string(), arguments, folder_);
    const int code = program.wait();
    said_ = program.err();
    return code;
  }
  void write_config(const DataCase& c, const std::string& more = "") const {
    std::string subjects;
    for (const auto& s : c.subjects) subjects += (subjects.empty() ? "\"" : ", \"") + s + "\"";
    const std::string text = "[run]\nsystem = \"" + c.system + "\"\ndata = \"data\"\nlayout = \"" + c.layout +
                             "\"\nencoder = \"encoder.safetensors\"\noutput = \"model.safetensors\"\n" +
                             "work_folder = \"work\"\nthreads = 1\n" +
                             (subjects.empty() ? "" : "subjects = [" + subjects + "]\n") + "[model]\n" +
                             c.model + "[training]\nepochs = 2\ncheckpoint_every = 3\nexport_every = 1\n" +
                             more;
    ASSERT_TRUE(write_file(folder_ / "config.toml", std::string_view(text)));
  }
  TestFolder owned_;
  fs::path folder_ = owned_.path();
  std::string said_;
};

const DataCase kBiwi{"facexhubert",      "biwi-expressive", {"F1_01", "F1_41", "M2_02", "F1_37"}, 12, 25,
                     {"F1", "M2", "M3"}, "hidden = 8\n"};

const DataCase kCases[] = {
    kBiwi,
    {"facediffuser_v",
     "vocaset",
     {"FaceTalk_170728_03272_TA_sentence01", "FaceTalk_170904_00128_TA_sentence02"},
     12,
     60,
     {"FaceTalk_170728_03272_TA", "FaceTalk_170904_00128_TA"},
     "latent = 8\nhidden = 8\ndiffusion_steps = 30\nschedule = \"linear\"\n"},
    {"facediffuser_v",
     "multiface",
     {"2_01", "3_02", "2_41"},
     12,
     30,
     {"2", "3"},
     "latent = 8\nhidden = 8\nlayers = 1\ndiffusion_steps = 30\n"},
    {"facediffuser_beat",
     "beat",
     {"2_0_01", "2_0_02", "2_0_03", "4_1_01", "4_1_02", "4_1_03"},
     51,
     30,
     {},
     "latent = 8\nhidden = 6\ndiffusion_steps = 30\n"},
    {"facediffuser_damm",
     "uudamm",
     {"1_2181", "2_1873", "1_968"},
     192,
     30,
     {},
     "latent = 8\nhidden = 8\ndiffusion_steps = 30\n"},
};

TEST_F(FaceProgram, MakesAModelOfEveryDataSet) {
  for (const DataCase& c : kCases) {
    SCOPED_TRACE(c.layout);
    for (const char* old : {"data", "work", "model.safetensors"}) fs::remove_all(folder_ / old);
    write_data(folder_ / "data", c);
    write_config(c);
    ASSERT_EQ(train({"config.toml"}), 0) << said_;
    const auto file = SafetensorsFile::open(folder_ / "model.safetensors");
    ASSERT_TRUE(file) << file.error().message();
    const auto model = read_model_file(file->metadata());
    ASSERT_TRUE(model) << model.error().message();
    EXPECT_EQ(architecture_name(model->architecture), c.system);
    EXPECT_EQ(model->output.channels, c.width);
    EXPECT_EQ(model->subjects, c.subjects);
    EXPECT_EQ(model->encoder, small_encoder());
    if (c.system == "facexhubert") {
      const auto sizes = facexhubert::sizes_of(*file);
      ASSERT_TRUE(sizes);
      EXPECT_EQ(sizes->hidden, 8);
      EXPECT_EQ(sizes->num_subjects, 3);
    } else {
      const auto sizes = facediffuser::sizes_of(*file);
      ASSERT_TRUE(sizes);
      EXPECT_EQ(sizes->latent, 8);
      ASSERT_TRUE(model->diffusion);
      EXPECT_EQ(model->diffusion->steps, 30);
    }
    if (!c.subjects.empty()) {
      EXPECT_TRUE(read_template(*file, c.subjects.front()));
    }
    EXPECT_TRUE(fs::exists(folder_ / "work" / "epoch_1.safetensors"));
  }
}

// Each trains from a field of the configuration, and what comes out moves a face.
TEST_F(FaceProgram, MakesAblationsThatAnimate) {
  AudioClip clip{std::vector<float>(12000), 16000};
  for (std::size_t i = 0; i < clip.samples.size(); ++i)
    clip.samples[i] = 0.3f * std::sin(0.1f * static_cast<float>(i));
  const auto trains = [&](const DataCase& c, const std::string& model, const std::string& training = "") {
    SCOPED_TRACE(c.system + " " + model);
    for (const char* old : {"work", "model.safetensors"}) fs::remove_all(folder_ / old);
    DataCase changed = c;
    changed.model += model;
    write_config(changed, training);
    ASSERT_EQ(train({"config.toml"}), 0) << said_;
    const auto loaded = FaceModel::load(folder_ / "model.safetensors");
    ASSERT_TRUE(loaded) << loaded.error().message();
    Progress progress;
    const auto takes = animate(*loaded, clip, {}, 1, 1, progress);
    ASSERT_TRUE(takes) << takes.error().message();
    EXPECT_GT(takes->front().num_frames(), 5);
    for (const float v : takes->front().values) EXPECT_TRUE(std::isfinite(v));
  };
  write_data(folder_ / "data", kBiwi);
  trains(kBiwi, "decoder = \"lstm\"\n");
  trains(kBiwi, "decoder = \"transformer\"\nheads = 2\n", "teacher_forcing = true\n");
  fs::remove_all(folder_ / "data");
  const DataCase& multiface = kCases[2];
  write_data(folder_ / "data", multiface);
  trains(multiface, "decoder = \"rnn\"\nnoise_encoder = \"mlp\"\n");
  trains(multiface, "decoder = \"transformer\"\nnoise_encoder = \"conv_average\"\n");
  trains(multiface, "diffusion = false\n");
}

TEST_F(FaceProgram, LearnsWhatIsNotFrozenAndGoesOnWhereItStopped) {
  write_data(folder_ / "data", kBiwi);
  write_config(kBiwi);
  ASSERT_EQ(train({"config.toml"}), 0) << said_;
  const auto start = SafetensorsFile::open(folder_ / "encoder.safetensors"),
             end = SafetensorsFile::open(folder_ / "model.safetensors");
  ASSERT_TRUE(start && end);
  for (const auto& t : start->tensors()) {
    if (t.name.ends_with("masked_spec_embed") || t.name.find("k_proj.bias") != std::string::npos) continue;
    const bool frozen = t.name.find("feature_") != std::string::npos ||
                        t.name.find(".layers.0.") != std::string::npos ||
                        t.name.find(".layers.1.") != std::string::npos;
    EXPECT_EQ(*start->read_float(t.name) == *end->read_float(t.name), frozen) << t.name;
  }
  // A finished run has nothing left to do, and a snapshot is what it wrote.
  const auto first = read_file(folder_ / "model.safetensors");
  ASSERT_EQ(train({"config.toml"}), 0) << said_;
  ASSERT_EQ(train({"config.toml", "--snapshot", "snapshot.safetensors"}), 0) << said_;
  EXPECT_EQ(*read_file(folder_ / "model.safetensors"), *first);
  EXPECT_EQ(*read_file(folder_ / "snapshot.safetensors"), *first);
}

TEST_F(FaceProgram, NamesWhatIsWrong) {
  write_data(folder_ / "data", kBiwi);
  const auto fails = [&](int code, const std::string& word) {
    EXPECT_EQ(train({"config.toml"}), code) << said_;
    EXPECT_NE(said_.find(word), std::string::npos) << said_;
  };
  write_config(kBiwi, "frozen = [\"audio_encoder.layers\"]\n");
  fails(2, "audio_encoder.layers");
  write_config(kBiwi, "[random]\nmask = \"half\"\n");
  fails(2, "half");
  write_config(kBiwi, "teacher_forcing = true\n");
  fails(2, "teacher_forcing");
  DataCase decoder = kBiwi;
  decoder.model += "decoder = \"perceptron\"\n";
  write_config(decoder);
  fails(2, "perceptron");
  write_config(kBiwi, "epoches = 3\n");
  fails(2, "epoches");
  DataCase other = kBiwi;
  other.system = "facediffuser_beat";
  write_config(other);
  fails(4, "biwi-expressive");
  other.system = "facediffuser_v";
  other.model = "diffusion_steps = 20\nschedule = \"linear\"\n";  // the last beta would be 1
  write_config(other);
  fails(2, "diffusion_steps");
  other.system = "faceformer";
  write_config(other);
  fails(2, "faceformer");
  other = kBiwi;
  other.subjects = {"F7"};
  write_config(other);
  fails(4, "train");
  write_config(kBiwi);
  fs::remove(folder_ / "encoder.safetensors");
  fails(3, "encoder.safetensors");
}

}  // namespace
}  // namespace mien
