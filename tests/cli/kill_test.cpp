// A program that is killed leaves under the names of its outputs what was there before, or the whole new
// file, and beside them nothing.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>

#include "program.h"
#include "running_program.h"
#include "test_paths.h"

namespace mien {
namespace {

class Kill : public ProgramTest {
 protected:
  void SetUp() override { write_wav("long.wav", syllables(60)); }
  // Animates long.wav to the outputs, and kills the program when it reports progress of the stage.
  void kill_in(const std::string& stage, const std::string& steps, const std::vector<std::string>& outputs) {
    std::vector<std::string> words = {"animate", "long.wav", "--model", "small.safetensors",
                                      "--steps", steps,      "--json"};
    for (const auto& output : outputs) words.insert(words.end(), {"-o", output});
    RunningProgram run(built_path("bin/mien").string(), words, in_folder(""));
    ASSERT_TRUE(run.says(R"("type":"progress","stage":")" + stage + '"')) << run.err();
    run.send(SIGKILL);
    ASSERT_EQ(run.wait(), 128 + SIGKILL) << run.err();
  }
  // Where the file system has no files without a name, hidden temporary ones are left behind and not counted.
  [[nodiscard]] std::vector<std::string> files_left() const {
    auto names = files();
#ifdef O_TMPFILE
    const int unnamed = ::open(in_folder("").c_str(), O_TMPFILE | O_WRONLY, 0600);
    if (unnamed >= 0) {
      ::close(unnamed);
      return names;
    }
#endif
    std::erase_if(names, [](const std::string& name) { return name.starts_with("."); });
    return names;
  }
};

TEST_F(Kill, WhileItAnimates) {
  write("old.csv", "an older motion");
  const auto before = files_left();
  kill_in("animating", "1000", {"a.glb", "old.csv", "a.json", "a.npy", "a.mp4"});
  EXPECT_EQ(files_left(), before);
  EXPECT_EQ(as_text(bytes_of("old.csv")), "an older motion");
}

TEST_F(Kill, WhileItFilms) {
  const std::vector<std::string> endings = {".glb", ".csv", ".json", ".npy"};
  std::vector<std::string> words = {"animate", "long.wav", "--model", "small.safetensors", "--steps", "1"};
  for (const auto& ending : endings) words.insert(words.end(), {"-o", "whole" + ending});
  ASSERT_EQ(mien(words).exit_code, 0);
  const auto before = files_left().size();
  kill_in("rendering", "1", {"a.glb", "a.csv", "a.json", "a.npy", "a.mp4"});
  for (const auto& ending : endings)  // they are written before the film
    EXPECT_TRUE(bytes_of("a" + ending) == bytes_of("whole" + ending)) << ending;
  EXPECT_FALSE(std::filesystem::exists(in_folder("a.mp4")));
  EXPECT_EQ(files_left().size(), before + endings.size());
}

}  // namespace
}  // namespace mien
