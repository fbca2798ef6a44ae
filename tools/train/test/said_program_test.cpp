// mien-train on a folder of coefficients and sound: from a configuration file to a model of SAiD.
#include <gtest/gtest.h>

#include <cmath>

#include "mien/base/file.h"
#include "mien/core/arkit.h"
#include "mien/models/model_file.h"
#include "mien/models/said/network.h"
#include "mien/models/said/said_model.h"
#include "running_program.h"
#include "small_encoder.h"
#include "test_folder.h"

namespace mien {
namespace {

namespace fs = std::filesystem;

void write_coefficients(const fs::path& path, int num_frames) {
  const auto names = arkit_order(ArkitOrder::said);
  std::string text;
  for (const auto& name : names) text += (text.empty() ? "" : ",") + name;
  for (int n = 0; n < num_frames; ++n) {
    text += '\n';
    for (std::size_t k = 0; k < names.size(); ++k)
      text += (k == 0 ? "" : ",") + std::to_string(0.4 + 0.3 * std::sin(0.1 * n + static_cast<double>(k)));
  }
  fs::create_directories(path.parent_path());
  ASSERT_TRUE(write_file(path, std::string_view(text + "\n")));
}

class SaidProgram : public testing::Test {
 protected:
  void SetUp() override {
    write_encoder(folder_ / "encoder.safetensors");
    for (const char* name : {"FaceTalk_170725_00137_TA/sentence01", "FaceTalk_170728_03272_TA/sentence02",
                             "FaceTalk_170908_03277_TA/sentence01", "FaceTalk_170731_00024_TA/sentence01"}) {
      write_coefficients(folder_ / "data" / (std::string(name) + ".csv"), 45);
      write_wav(folder_ / "sound" / (std::string(name) + ".wav"), 12000);
    }
    write_coefficients(folder_ / "data/FaceTalk_170725_00137_TA/sentence03.csv", 45);  // has no sound
  }
  void write_config(const std::string& model = "", const std::string& training = "",
                    const std::string& run = "sound = \"sound\"\n") const {
    const std::string text =
        "[run]\nsystem = \"said\"\ndata = \"data\"\nencoder = \"encoder.safetensors\"\noutput = "
        "\"model.safetensors\"\nwork_folder = \"work\"\nthreads = 1\n" +
        run + "[model]\nwidth = 32\ndiffusion_steps = 20\n" + model +
        "[training]\nepochs = 3\nbatch = 2\nshortest_window = 24\nlearning_rate = 1e-3\nwarm_up_epochs = 1\n"
        "checkpoint_every = 2\nvalidate_every = 1\nvalidation_passes = 1\nexport_every = 2\n" +
        training;
    ASSERT_TRUE(write_file(folder_ / "config.toml", std::string_view(text)));
  }
  int train(const std::vector<std::string>& arguments) {
    RunningProgram program(MIEN_TRAIN_PROGRAM, arguments, folder_);
    const int code = program.wait();
    said_ = program.err();
    return code;
  }
  TestFolder owned_;
  fs::path folder_ = owned_.path();
  std::string said_;
};

TEST_F(SaidProgram, MakesAModel) {
  write_config();
  ASSERT_EQ(train({"config.toml"}), 0) << said_;
  EXPECT_NE(said_.find("2 sequences to learn from, 1 to validate"), std::string::npos) << said_;
  EXPECT_NE(said_.find("1 sequences have no sound"), std::string::npos) << said_;
  EXPECT_NE(said_.find("validation loss"), std::string::npos) << said_;
  EXPECT_TRUE(fs::exists(folder_ / "work/epoch_1.safetensors"));
  const auto file = SafetensorsFile::open(folder_ / "model.safetensors");
  ASSERT_TRUE(file) << file.error().message();
  const auto model = read_model_file(file->metadata());
  ASSERT_TRUE(model) << model.error().message();
  EXPECT_EQ(model->architecture, Architecture::said);
  EXPECT_EQ(model->output.channels, 32);
  EXPECT_EQ(model->output.fps, 60);
  EXPECT_EQ(model->encoder, small_encoder());
  ASSERT_TRUE(model->diffusion);
  EXPECT_EQ(model->diffusion->steps, 20);
  const auto sizes = said::sizes_of(*file);
  ASSERT_TRUE(sizes) << sizes.error().message();
  EXPECT_EQ(sizes->width, 32);
  EXPECT_EQ(sizes->context, 16);
  // Frozen as published, and a finished run has nothing left to do.
  const auto start = SafetensorsFile::open(folder_ / "encoder.safetensors");
  for (const auto& t : start->tensors())
    EXPECT_EQ(*start->read_float(t.name), *file->read_float(t.name)) << t.name;
  const auto first = read_file(folder_ / "model.safetensors");
  ASSERT_EQ(train({"config.toml", "--snapshot", "snapshot.safetensors"}), 0) << said_;
  EXPECT_EQ(*read_file(folder_ / "snapshot.safetensors"), *first);
}

TEST_F(SaidProgram, TrainsThePapersAblations) {
  const auto trains = [&](const std::string& model, const std::string& training) {
    SCOPED_TRACE(model + training);
    for (const char* old : {"work", "model.safetensors"}) fs::remove_all(folder_ / old);
    write_config(model, training);
    ASSERT_EQ(train({"config.toml", "--quiet"}), 0) << said_;
    const auto loaded = SaidModel::load(folder_ / "model.safetensors");
    ASSERT_TRUE(loaded) << loaded.error().message();
    Progress progress;
    SaidOptions options;
    options.sampling.num_steps = 4;
    const auto takes = animate(*loaded, {std::vector<float>(8000, 0.1f), 16000}, options, 1, 1, progress);
    ASSERT_TRUE(takes) << takes.error().message();
    EXPECT_EQ(takes->front().num_frames(), 30);
  };
  trains("", "loss = \"squared\"\n");
  trains("", "velocity_weight = 0.0\n");
  trains("", "frozen = []\n");
  trains("alignment_bias = false\n", "");
  const auto file = SafetensorsFile::open(folder_ / "model.safetensors");
  ASSERT_TRUE(file);
  EXPECT_EQ(read_model_file(file->metadata())->sizes.at("alignment_bias"), 0);
}

TEST_F(SaidProgram, NamesWhatIsWrong) {
  const auto fails = [&](int code, const std::string& word) {
    EXPECT_EQ(train({"config.toml", "--quiet"}), code) << said_;
    EXPECT_NE(said_.find(word), std::string::npos) << said_;
  };
  write_config("", "loss = \"cubic\"\n");
  fails(2, "absolute");
  write_config("width_of = 3\n");
  fails(2, "width_of");
  write_config("", "frozen = [\"audio\"]\n");
  fails(2, "audio");
  write_config("", "", "sound = \"elsewhere\"\n");
  fails(4, "sound");
  write_coefficients(folder_ / "two.csv", 2);
  write_config("", "", "sound = \"sound\"\ndeviation = \"two.csv\"\n");
  fails(4, "2 rows");
  fs::remove_all(folder_ / "data");
  write_config();
  fails(3, "data");
}

}  // namespace
}  // namespace mien
