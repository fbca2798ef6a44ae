// mien-train is killed in the middle, again and again, and goes on.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "mien/base/file.h"
#include "running_program.h"
#include "small_set.h"
#include "test_folder.h"

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

std::string text_of(const fs::path& path) {
  const auto bytes = read_file(path);
  return bytes ? std::string(as_text(*bytes)) : "";
}

class Training : public testing::Test {
 protected:
  fs::path new_run(const std::string& name) const {
    const fs::path run = folder_.path() / name;
    fs::create_directory(run);
    write_small_set(run / "set.safetensors");
    EXPECT_TRUE(write_file(run / "config.toml", kConfig));
    return run;
  }
  static std::unique_ptr<RunningProgram> start(const fs::path& run) {
    return std::make_unique<RunningProgram>(MIEN_TRAIN_PROGRAM,
                                            std::vector<std::string>{"config.toml", "--quiet"}, run);
  }
  static std::string log_of(const fs::path& run) { return text_of(run / "work/log.tsv"); }
  static std::size_t lines_of(const std::string& log) {
    return static_cast<std::size_t>(std::count(log.begin(), log.end(), '\n'));
  }
  // Starts a run, kills it when its log has so many lines, and looks at what it left.
  static void kill_at(const fs::path& run, std::size_t lines) {
    const auto program = start(run);
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::minutes(2);
    // Of a resumed run: first it cuts the log back to its checkpoint.
    while (lines_of(log_of(run)) < lines && std::chrono::steady_clock::now() < deadline)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    program->send(SIGKILL);
    ASSERT_EQ(program->wait(), 128 + SIGKILL) << program->err();
    ASSERT_LT(lines_of(log_of(run)), kSteps) << "it was through before it was killed";
    EXPECT_FALSE(fs::exists(run / "model.safetensors"));
  }

  TestFolder folder_;
};

TEST_F(Training, GoesOnAfterBeingKilledWithTheSameLosses) {
  const fs::path whole = new_run("whole"), killed = new_run("killed");
  const auto program = start(whole);
  ASSERT_EQ(program->wait(), 0) << program->err();
  ASSERT_EQ(lines_of(log_of(whole)), kSteps);

  kill_at(killed, 3);   // before the first checkpoint
  kill_at(killed, 12);  // after it
  kill_at(killed, 26);
  kill_at(killed, kMeanSteps + 10);
  kill_at(killed, kMeanSteps + kDiffusionSteps + 9);
  const auto last = start(killed);
  ASSERT_EQ(last->wait(), 0) << last->err();
  EXPECT_EQ(log_of(killed), log_of(whole));
  EXPECT_TRUE(text_of(killed / "model.safetensors") == text_of(whole / "model.safetensors"));
}

}  // namespace
}  // namespace mien::train
