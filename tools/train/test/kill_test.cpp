// mien-train is killed in the middle, again and again, and goes on.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "mien/base/file.h"
#include "running_program.h"
#include "small_encoder.h"
#include "small_mead.h"
#include "small_set.h"
#include "test_folder.h"
#include "test_paths.h"

namespace mien::train {
namespace {

namespace fs = std::filesystem;

// Checkpoints lie between the steps at which the test kills.
constexpr const char* kConfig = R"([run]
name = "small"
data = "set.safetensors"
output = "model.safetensors"
work_folder = "work"
threads = 1
[model]
width = 16
condition = 8
diffusion_hidden = 24
blink_hidden = 16
[mean]
steps = 40
batch = 2
crop_frames = 60
warm_up_steps = 5
checkpoint_every = 7
[diffusion]
steps = 30
batch = 2
sequence_chunks = 20
warm_up_steps = 5
checkpoint_every = 7
[blink]
steps = 20
warm_up_steps = 5
checkpoint_every = 7
[brow]
steps = 10
)";
constexpr std::size_t kMeanSteps = 40, kDiffusionSteps = 30, kSteps = 100;

// Everything that is random is on; models are written between epochs.
constexpr const char* kSaidConfig = R"([run]
system = "said"
data = "data"
encoder = "encoder.safetensors"
output = "model.safetensors"
work_folder = "work"
threads = 1
[model]
width = 32
diffusion_steps = 20
[training]
epochs = 20
batch = 2
shortest_window = 24
learning_rate = 1e-3
warm_up_epochs = 2
checkpoint_every = 7
export_every = 6
)";
constexpr std::size_t kSaidSteps = 40;  // two batches of two for three sequences, twenty times

// Both stages of ProbTalk3D. The validation of every epoch is part of the state.
constexpr const char* kPriorConfig = R"([run]
system = "probtalk3d_prior"
data = "mead"
output = "model.safetensors"
work_folder = "work"
threads = 1
[model]
width = 16
inner = 24
heads = 2
blocks = 1
codes = 12
code_width = 8
[training]
epochs = 15
learning_rate = 1e-3
patience = 15
checkpoint_every = 7
)";
constexpr const char* kTalkingConfig = R"([run]
system = "probtalk3d"
data = "mead"
prior = "prior.safetensors"
encoder = "encoder.safetensors"
output = "model.safetensors"
work_folder = "work"
threads = 1
[model]
blocks = 1
[training]
epochs = 15
learning_rate = 1e-3
monitor = "epoch_mean"
keep = "best"
patience = 15
checkpoint_every = 7
)";
constexpr std::size_t kTalkingSteps = 45;  // three clips, fifteen times

std::string text_of(const fs::path& path) {
  const auto bytes = read_file(path);
  return bytes ? std::string(as_text(*bytes)) : "";
}

class Training : public testing::Test {
 protected:
  fs::path new_run(const std::string& name, const char* config) const {
    const fs::path run = folder_.path() / name;
    fs::create_directory(run);
    EXPECT_TRUE(write_file(run / "config.toml", config));
    return run;
  }
  fs::path new_default_run(const std::string& name) const {
    const fs::path run = new_run(name, kConfig);
    write_small_set(run / "set.safetensors");
    return run;
  }
  fs::path new_said_run(const std::string& name) const {
    const fs::path run = new_run(name, kSaidConfig);
    write_encoder(run / "encoder.safetensors");
    for (const char* sentence : {"data/A/sentence01", "data/A/sentence02", "data/B/sentence01"}) {
      write_coefficients(run / (std::string(sentence) + ".csv"), 45, 0.1);
      write_wav(run / (std::string(sentence) + ".wav"), 12000);
    }
    return run;
  }
  fs::path new_mead_run(const std::string& name, const char* config) const {
    const fs::path run = new_run(name, config);
    write_encoder(run / "encoder.safetensors");
    write_mead_parameters(run / "mead",
                          {"M003_001_0_0", "M003_002_1_2", "W029_003_7_0", "W029_033_0_0", "M032_001_0_0"});
    return run;
  }
  static std::unique_ptr<RunningProgram> start(const fs::path& run) {
    return std::make_unique<RunningProgram>(built_path("bin/mien-train").string(),
                                            std::vector<std::string>{"config.toml", "--quiet"}, run);
  }
  static std::string log_of(const fs::path& run) { return text_of(run / "work/log.tsv"); }
  static std::size_t lines_of(const std::string& log) {
    return static_cast<std::size_t>(std::count(log.begin(), log.end(), '\n'));
  }
  // Starts a run, kills it when its log has so many lines, and looks at what it left.
  static void kill_at(const fs::path& run, std::size_t lines, std::size_t steps) {
    const auto program = start(run);
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::minutes(2);
    // Of a resumed run: first it cuts the log back to its checkpoint.
    while (lines_of(log_of(run)) < lines && std::chrono::steady_clock::now() < deadline)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    program->send(SIGKILL);
    ASSERT_EQ(program->wait(), 128 + SIGKILL) << program->err();
    ASSERT_LT(lines_of(log_of(run)), steps) << "it was through before it was killed";
    EXPECT_FALSE(fs::exists(run / "model.safetensors"));
  }

  // One run is left alone, the other killed when its log has so many lines.
  static void expect_same(const fs::path& whole, const fs::path& killed,
                          const std::vector<std::size_t>& lines, std::size_t steps) {
    const auto program = start(whole);
    ASSERT_EQ(program->wait(), 0) << program->err();
    ASSERT_EQ(lines_of(log_of(whole)), steps);
    for (const std::size_t at : lines) kill_at(killed, at, steps);
    const auto last = start(killed);
    ASSERT_EQ(last->wait(), 0) << last->err();
    EXPECT_EQ(log_of(killed), log_of(whole));
    EXPECT_TRUE(text_of(killed / "model.safetensors") == text_of(whole / "model.safetensors"));
  }

  TestFolder folder_;
};

TEST_F(Training, GoesOnAfterBeingKilledWithTheSameLosses) {
  expect_same(new_default_run("whole"), new_default_run("killed"),
              // before the first checkpoint, after it ...
              {3, 12, 26, kMeanSteps + 10, kMeanSteps + kDiffusionSteps + 9}, kSteps);
}

TEST_F(Training, OfSaidGoesOnAfterBeingKilledWithTheSameLosses) {
  const fs::path whole = new_said_run("whole"), killed = new_said_run("killed");
  expect_same(whole, killed, {3, 12, 26, 33}, kSaidSteps);
  for (const char* model :
       {"work/epoch_5.safetensors", "work/epoch_11.safetensors", "work/epoch_17.safetensors"})
    EXPECT_TRUE(text_of(killed / model) == text_of(whole / model)) << model;
}

TEST_F(Training, OfBothStagesOfProbTalk3DGoesOnAfterBeingKilledWithTheSameLosses) {
  const fs::path prior = new_mead_run("prior", kPriorConfig);
  expect_same(prior, new_mead_run("killed_prior", kPriorConfig), {3, 12, 26, 41}, 4 * 15);
  const fs::path whole = new_mead_run("whole", kTalkingConfig),
                 killed = new_mead_run("killed", kTalkingConfig);
  for (const fs::path& run : {whole, killed})
    fs::copy_file(prior / "model.safetensors", run / "prior.safetensors");
  expect_same(whole, killed, {3, 12, 26, 33}, kTalkingSteps);
  EXPECT_TRUE(text_of(killed / "work/best.safetensors") == text_of(whole / "work/best.safetensors"));
}

}  // namespace
}  // namespace mien::train
