// mien-train on a folder of coefficients: from a configuration file to a codec that runs.
#include <gtest/gtest.h>

#include <cmath>

#include "mien/base/file.h"
#include "mien/models/model_file.h"
#include "mien/models/said/vae.h"
#include "running_program.h"
#include "small_encoder.h"
#include "test_folder.h"
#include "test_paths.h"

namespace mien {
namespace {

namespace fs = std::filesystem;

class SaidVaeProgram : public testing::Test {
 protected:
  void SetUp() override {
    write_coefficients(folder_ / "data/FaceTalk_170725_00137_TA/sentence01.csv", 60, 0.1);
    write_coefficients(folder_ / "data/FaceTalk_170725_00137_TA/sentence02.csv", 45, 0.2);
    write_coefficients(folder_ / "data/FaceTalk_170728_03272_TA/sentence01.csv", 50, 0.15);
    write_coefficients(folder_ / "data/FaceTalk_170908_03277_TA/sentence01.csv", 70, 0.12);
    write_coefficients(folder_ / "data/FaceTalk_170731_00024_TA/sentence01.csv", 70, 0.12);
    write_config();
  }
  void write_config(const std::string& run = "", const std::string& training = "") const {
    const std::string text =
        "[run]\nsystem = \"said_vae\"\ndata = \"data\"\noutput = \"codec.safetensors\"\nwork_folder = "
        "\"work\"\n"
        "threads = 1\n" +
        run +
        "[model]\nwindow = 32\nlatent = 8\n[training]\nepochs = 3\nbatch = 2\n"
        "checkpoint_every = 2\nvalidate_every = 1\n" +
        training;
    ASSERT_TRUE(write_file(folder_ / "config.toml", std::string_view(text)));
  }
  int train(const std::vector<std::string>& arguments) {
    RunningProgram program(built_path("bin/mien-train").string(), arguments, folder_);
    const int code = program.wait();
    said_ = program.err();
    return code;
  }
  TestFolder owned_;
  fs::path folder_ = owned_.path();
  std::string said_;
};

TEST_F(SaidVaeProgram, MakesACodecThatRuns) {
  ASSERT_EQ(train({"config.toml"}), 0) << said_;
  EXPECT_NE(said_.find("3 sequences to learn from, 1 to validate"), std::string::npos) << said_;
  EXPECT_NE(said_.find("reconstruction error"), std::string::npos) << said_;
  const auto codec = said::load_vae(folder_ / "codec.safetensors");
  ASSERT_TRUE(codec) << codec.error().message();
  EXPECT_EQ(codec->encoder.sizes.window, 32);
  EXPECT_EQ(codec->encoder.sizes.latent, 8);
  const auto file = SafetensorsFile::open(folder_ / "codec.safetensors");
  EXPECT_NE(read_model_file(file->metadata())->training_config.find("epochs = 3"), std::string::npos);
  for (const float v : said::window_features(*codec, Tensor({40, 32}), 9).values())
    EXPECT_TRUE(std::isfinite(v));

  const auto first = read_file(folder_ / "codec.safetensors");
  ASSERT_EQ(train({"config.toml", "--snapshot", "snapshot.safetensors"}), 0) << said_;
  EXPECT_EQ(*read_file(folder_ / "snapshot.safetensors"), *first);
}

TEST_F(SaidVaeProgram, NamesWhatIsWrong) {
  const auto fails = [&](int code, const std::string& word) {
    EXPECT_EQ(train({"config.toml", "--quiet"}), code) << said_;
    EXPECT_NE(said_.find(word), std::string::npos) << said_;
  };
  write_config("", "batch_size = 3\n");
  fails(2, "batch_size");
  write_config("", "rising = 0.0\n");
  fails(2, "rising");
  write_config("deviation = \"absent.csv\"\n");
  fails(3, "absent.csv");
  write_coefficients(folder_ / "two.csv", 2, 0.1);
  write_config("deviation = \"two.csv\"\n");
  fails(4, "2 rows");
  write_config();
  fs::remove_all(folder_ / "data");
  fails(3, "data");
}

}  // namespace
}  // namespace mien
