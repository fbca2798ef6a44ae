// mien-train on a folder of coefficients and sound: from a configuration file to a model of SAiD.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "mien/base/file.h"
#include "mien/datasets/coefficient_folder.h"
#include "mien/models/model_file.h"
#include "mien/models/said/network.h"
#include "mien/models/said/said_model.h"
#include "running_program.h"
#include "small_encoder.h"
#include "test_folder.h"
#include "test_paths.h"

namespace mien {
namespace {

namespace fs = std::filesystem;

class SaidProgram : public testing::Test {
 protected:
  void SetUp() override {
    write_encoder(folder_ / "encoder.safetensors");
    for (const char* name : {"FaceTalk_170725_00137_TA/sentence01", "FaceTalk_170728_03272_TA/sentence02",
                             "FaceTalk_170908_03277_TA/sentence01", "FaceTalk_170731_00024_TA/sentence01"}) {
      write_coefficients(folder_ / "data" / (std::string(name) + ".csv"), 45, 0.1);
      write_wav(folder_ / "sound" / (std::string(name) + ".wav"), 12000);
    }
    write_coefficients(folder_ / "data/FaceTalk_170725_00137_TA/sentence03.csv", 45, 0.1);  // has no sound
  }
  void write_config(const std::string& model = "", const std::string& training = "",
                    const std::string& run = "sound = \"sound\"\n", int epochs = 3) const {
    const std::string text =
        "[run]\nsystem = \"said\"\ndata = \"data\"\nencoder = \"encoder.safetensors\"\noutput = "
        "\"model.safetensors\"\nwork_folder = \"work\"\nthreads = 1\n" +
        run + "[model]\nwidth = 32\ndiffusion_steps = 20\n" + model +
        "[training]\nepochs = " + std::to_string(epochs) +
        "\nbatch = 2\nshortest_window = 24\nlearning_rate = 1e-3\nwarm_up_epochs = 1\n"
        "checkpoint_every = 2\nvalidate_every = 1\nvalidation_passes = 1\nexport_every = 2\n" +
        training;
    ASSERT_TRUE(write_file(folder_ / "config.toml", std::string_view(text)));
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
  [[nodiscard]] std::string log() const {
    const auto bytes = read_file(folder_ / "work/log.tsv");
    return bytes ? std::string(as_text(*bytes)) : "";
  }
  /// The largest change of a tensor between two model files.
  [[nodiscard]] static double change(const SafetensorsFile& from, const SafetensorsFile& to,
                                     const std::string& name, const std::string& name_there) {
    const auto a = from.read_float(name), b = to.read_float(name_there);
    if (!a || !b) throw std::runtime_error("no tensor '" + name + "' or '" + name_there + "'");
    double largest = 0;
    for (std::size_t i = 0; i < a->size(); ++i)
      largest = std::max(largest, std::abs(static_cast<double>((*a)[i]) - static_cast<double>((*b)[i])));
    return largest;
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
  // The encoder is frozen as published; what is kept is the average of the weights.
  const auto start = SafetensorsFile::open(folder_ / "encoder.safetensors"),
             state = SafetensorsFile::open(folder_ / "work/checkpoint.safetensors");
  ASSERT_TRUE(start && state);
  for (const auto& t : start->tensors()) EXPECT_EQ(change(*start, *file, t.name, t.name), 0) << t.name;
  const std::string last = "denoiser.model.out.2.weight";
  EXPECT_EQ(change(*file, *state, last, "average." + last), 0);
  EXPECT_GT(change(*file, *state, last, last), 0);
  // So is what is validated and exported on the way: a run that ends there delivers the same.
  write_config("", "", "sound = \"sound\"\n", 2);
  ASSERT_EQ(train({"config.toml", "--quiet", "--work-folder", "work2", "-o", "two.safetensors"}), 0) << said_;
  const auto on_the_way = SafetensorsFile::open(folder_ / "work/epoch_1.safetensors"),
             two = SafetensorsFile::open(folder_ / "two.safetensors"),
             two_state = SafetensorsFile::open(folder_ / "work2/checkpoint.safetensors");
  ASSERT_TRUE(on_the_way && two && two_state);
  EXPECT_EQ(change(*on_the_way, *two_state, last, "average." + last), 0);
  EXPECT_EQ(change(*on_the_way, *two, last, last), 0);
  EXPECT_GT(change(*on_the_way, *two_state, last, last), 0);
  write_config();
  // A finished run has nothing left to do.
  const auto first = read_file(folder_ / "model.safetensors");
  ASSERT_EQ(train({"config.toml", "--snapshot", "snapshot.safetensors"}), 0) << said_;
  EXPECT_EQ(*read_file(folder_ / "snapshot.safetensors"), *first);
}

TEST_F(SaidProgram, TheSameSeedGivesTheSameModel) {
  write_config();
  ASSERT_EQ(train({"config.toml", "--quiet"}), 0) << said_;
  ASSERT_EQ(train({"config.toml", "--quiet", "--work-folder", "work2", "-o", "again.safetensors"}), 0)
      << said_;
  EXPECT_EQ(*read_file(folder_ / "model.safetensors"), *read_file(folder_ / "again.safetensors"));
  const std::string first = log();
  write_config("", "", "sound = \"sound\"\nseed = 2\n");
  fs::remove_all(folder_ / "work");
  ASSERT_EQ(train({"config.toml", "--quiet"}), 0) << said_;
  EXPECT_NE(log(), first);
}

/// Half a second of a tone that comes and goes, performed by a model file.
Result<std::vector<float>> performed(const fs::path& path) {
  MIEN_TRY(const SaidModel model, SaidModel::load(path));
  AudioClip clip{{}, 16000};
  for (int i = 0; i < 8000; ++i)
    clip.samples.push_back(static_cast<float>(0.3 * std::sin(0.1 * i) * std::sin(0.002 * i)));
  Progress progress;
  SaidOptions options;
  options.sampling.num_steps = 4;
  MIEN_TRY(const auto takes, animate(model, clip, options, 1, 1, progress));
  return takes.front().values;
}

TEST_F(SaidProgram, TrainsThePapersAblations) {
  std::set<std::string> logs;
  const auto trains = [&](const std::string& model, const std::string& training) {
    SCOPED_TRACE(model + training);
    for (const char* old : {"work", "model.safetensors"}) fs::remove_all(folder_ / old);
    write_config(model, training, "sound = \"sound\"\n", 8);
    ASSERT_EQ(train({"config.toml", "--quiet"}), 0) << said_;
    EXPECT_TRUE(logs.insert(log()).second) << "it learns as another one does";
    const auto values = performed(folder_ / "model.safetensors");
    ASSERT_TRUE(values) << values.error().message();
    EXPECT_EQ(values->size(), 30u * 32u);
  };
  trains("", "");
  trains("", "loss = \"squared\"\n");
  trains("", "velocity_weight = 0.0\n");
  trains("", "frozen = []\n");
  // Beyond the decay of weights, which is a hundredth of a step of 1e-3.
  const auto start = SafetensorsFile::open(folder_ / "encoder.safetensors"),
             tuned = SafetensorsFile::open(folder_ / "model.safetensors");
  ASSERT_TRUE(start && tuned);
  const std::string name = "audio_encoder.encoder.layers.1.feed_forward.output_dense.weight";
  EXPECT_GT(change(*start, *tuned, name, name), 1e-4);

  trains("alignment_bias = false\n", "");
  // Shapes do not tell it, but the file does: the same weights hear otherwise with the bias.
  const auto file = SafetensorsFile::open(folder_ / "model.safetensors");
  ASSERT_TRUE(file);
  ModelFile description = *read_model_file(file->metadata());
  EXPECT_EQ(description.sizes.at("alignment_bias"), 0);
  description.sizes.clear();
  auto writer =
      SafetensorsWriter::create(folder_ / "aligned.safetensors",
                                {file->tensors().begin(), file->tensors().end()}, to_metadata(description));
  ASSERT_TRUE(writer);
  for (const auto& t : file->tensors()) ASSERT_TRUE(writer->write_float(t.name, *file->read_float(t.name)));
  ASSERT_TRUE(writer->finish());
  EXPECT_NE(*performed(folder_ / "aligned.safetensors"), *performed(folder_ / "model.safetensors"));
}

TEST_F(SaidProgram, MienTrainsAndAnimates) {
  if (!std::filesystem::exists(built_path("bin/mien")))
    GTEST_SKIP() << "built without the program (MIEN_CLI, MIEN_FACE)";
  write_config();
  ASSERT_EQ(run(built_path("bin/mien").string(), {"train", "config.toml", "--quiet"}), 0) << said_;
  write_wav(folder_ / "hello.wav", 16000);
  ASSERT_EQ(run(built_path("bin/mien").string(), {"animate", "hello.wav", "--model", "model.safetensors",
                                                  "--steps", "5", "-o", "hello.said.csv", "--quiet"}),
            0)
      << said_;
  const auto motion = read_coefficients(folder_ / "hello.said.csv");
  ASSERT_TRUE(motion) << motion.error().message();
  EXPECT_EQ(motion->num_frames(), 60);
}

TEST_F(SaidProgram, TheFilesOfConfigsAreRead) {
  for (const char* name : {"said", "said_vae"}) {
    const auto config = project_path("configs/" + std::string(name) + ".toml");
    EXPECT_EQ(train({config.string(), "--quiet"}), 3)
        << said_ << ": what is absent here is data, not a field";
  }
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
  write_coefficients(folder_ / "two.csv", 2, 0.1);
  write_config("", "", "sound = \"sound\"\ndeviation = \"two.csv\"\n");
  fails(4, "2 rows");
  fs::remove_all(folder_ / "data");
  write_config();
  fails(3, "data");
}

}  // namespace
}  // namespace mien
