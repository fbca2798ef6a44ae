// mien-corpus is killed in the middle: no output appears, and the next run is not disturbed by what was left.
#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <thread>

#include "engine.h"
#include "mien/base/file.h"
#include "running_program.h"
#include "test_folder.h"
#include "test_paths.h"

namespace mien {
namespace {

namespace fs = std::filesystem;

class CorpusKill : public testing::Test {
 protected:
  void SetUp() override {
    if (find_engine(EngineId::flite) == nullptr) GTEST_SKIP() << "flite is absent";
  }
  [[nodiscard]] RunningProgram start(const std::vector<std::string>& words) const {
    return {built_path("bin/mien-corpus").string(), words, folder_.path()};
  }
  // Runs, and kills as soon as `begun` says so.
  void kill_when(const std::vector<std::string>& words, const std::function<bool()>& begun) const {
    RunningProgram program = start(words);
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::minutes(2);
    while (!begun() && std::chrono::steady_clock::now() < deadline)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    program.send(SIGKILL);
    ASSERT_EQ(program.wait(), 128 + SIGKILL) << "it was through before it was killed: " << program.err();
  }
  [[nodiscard]] std::uintmax_t size_of(const char* name) const {
    std::error_code absent;
    const auto size = fs::file_size(folder_ / name, absent);
    return absent ? 0 : size;
  }

  TestFolder folder_;
};

TEST_F(CorpusKill, PrepareLeavesNoSet) {
  const auto words = [](const char* output) {
    return std::vector<std::string>{"prepare", "-o",      output, "--hours", "0.02",   "--copies",
                                    "1",       "--takes", "1",    "-q",      "--jobs", "2"};
  };
  kill_when(words("a.safetensors"), [&] { return size_of("a.safetensors.spool") > 0; });
  EXPECT_FALSE(fs::exists(folder_ / "a.safetensors"));
  for (const char* output : {"a.safetensors", "b.safetensors"}) {
    RunningProgram program = start(words(output));
    ASSERT_EQ(program.wait(), 0) << program.err();
  }
  EXPECT_TRUE(*read_file(folder_ / "a.safetensors") == *read_file(folder_ / "b.safetensors"));
  EXPECT_FALSE(fs::exists(folder_ / "a.safetensors.spool"));
}

TEST_F(CorpusKill, BuildLeavesNoFolder) {
  const std::vector<std::string> words = {"build",   "-o",          "set",     "--split", "valid",
                                          "--voice", "flite:kal16", "-q",      "--clips", "12",
                                          "--jobs",  "2",           "--store", "items"};
  kill_when(words, [&] {
    std::error_code absent;
    const fs::directory_iterator phones(folder_ / "set.partial/phones", absent);
    return !absent && phones != fs::directory_iterator();
  });
  EXPECT_FALSE(fs::exists(folder_ / "set"));
  RunningProgram program = start(words);
  ASSERT_EQ(program.wait(), 0) << program.err();
  EXPECT_TRUE(fs::exists(folder_ / "set/corpus.json"));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_ / "set/phones"), fs::directory_iterator()), 12);
  EXPECT_FALSE(fs::exists(folder_ / "set.partial"));
}

}  // namespace
}  // namespace mien
