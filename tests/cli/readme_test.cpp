// What README.md shows works as it stands there: its command lines are run and its program is called.
#include <gmock/gmock.h>

#include <iostream>
#include <sstream>

#include "mien/base/file.h"
#include "mien/base/progress.h"
#include "mien/io/motion_file.h"
#include "program.h"
#include "test_paths.h"

mien::Status animate_file(mien::Progress& progress);  // the code block, see CMakeLists.txt

namespace mien {
namespace {

namespace fs = std::filesystem;

// They install packages and build the program; .ci/run and the demo's users run them.
constexpr const char* kSetUps[] = {"./demo", "./test"};

// Lines of code blocks that are indented or fenced as a shell's, without comments.
std::vector<std::string> command_lines(const std::string& markdown) {
  std::vector<std::string> lines;
  std::istringstream text(markdown);
  bool is_fenced = false, is_shell = false;
  for (std::string line; std::getline(text, line);) {
    if (line.starts_with("```")) {
      is_fenced = !is_fenced;
      is_shell = line == "```sh" || line == "```bash";
    } else if (is_fenced ? is_shell : line.starts_with("    ")) {
      line = line.substr(0, line.find(" #"));
      const auto first = line.find_first_not_of(' ');
      if (first != std::string::npos)
        lines.push_back(line.substr(first, line.find_last_not_of(' ') + 1 - first));
    }
  }
  return lines;
}

class Readme : public ProgramTest {
 protected:
  // All that the commands expect to find.
  void SetUp() override {
    const fs::path built = built_path("share/mien");
    fs::create_directories(in_folder("FOLDER/labels"));
    fs::create_directory(in_folder("share"));
    fs::copy(built / "head.glb", in_folder("share/head.glb"));
    fs::copy(built / "head.glb", in_folder("hero.glb"));
    fs::copy(in_folder("small.safetensors"), in_folder("share/default.safetensors"));
    fs::copy(in_folder("speech.wav"), in_folder("hello.wav"));
    fs::copy(in_folder("speech.wav"), in_folder("FOLDER/a.wav"));
    write("mood.csv", "time,emotion,intensity\n0,neutral,0\n1,happy,0.8\n");
    write("FOLDER/manifest.json",
          R"({"clips":[{"id":"a","file":"a.wav","labels":"labels/a.tsv","language":"en","speaker":"s",
              "style":"read","seconds":2}]})");
    write(
        "FOLDER/labels/a.tsv",
        "start\tend\tphone\tviseme\tclosure_start\tclosure_end\tconfidence\tflags\n"
        "0\t0.9\taa\tAA\t-\t-\t0.9\t-\n0.9\t1.0\tp\tPP\t0.9\t1.0\t0.95\t-\n1.0\t2.0\taa\tAA\t-\t-\t0.9\t-\n");
  }
};

TEST_F(Readme, CommandsRun) {
  const auto text = read_file(project_path("README.md"));
  ASSERT_TRUE(text) << text.error().message();
  const std::string path = built_path("bin").string();
  int num_run = 0;
  for (const auto& line : command_lines(std::string(as_text(*text)))) {
    SCOPED_TRACE(line);
    const std::string program = line.substr(0, line.find(' '));
    if (std::find(std::begin(kSetUps), std::end(kSetUps), program) != std::end(kSetUps)) {
      std::cout << "skipped: " << line << "\n";
      continue;
    }
    ASSERT_EQ(program, "mien") << "nothing here tests this command";
    const auto run = shell("export MIEN_SHARE=share; PATH='" + path + "':$PATH; " + line);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    std::istringstream words(line);
    for (std::string word, before; words >> word; before = word)
      if (before == "-o") {
        EXPECT_TRUE(fs::exists(in_folder(word))) << word;
      }
    ++num_run;
  }
  EXPECT_GE(num_run, 7);
}

TEST_F(Readme, LibraryExampleWritesTheMotionOfTheProgram) {
  const fs::path home = fs::current_path();
  fs::current_path(in_folder(""));
  Progress progress;
  const auto done = animate_file(progress);
  fs::current_path(home);
  ASSERT_TRUE(done) << done.error().message();
  ASSERT_EQ(mien({"animate", "hello.wav", "--model", "small.safetensors", "--seed", "7", "-o", "program.csv"})
                .exit_code,
            0);
  EXPECT_TRUE(bytes_of("hello.csv") == bytes_of("program.csv"));
}

TEST(ReadmeLines, AreThoseOfCodeBlocks) {
  EXPECT_THAT(
      command_lines("Text `mien x`\n\n    mien a  b   # why\n    # only this\n\n```cpp\n    int x;\n```\n"
                    "```sh\nmien c\n```\n"),
      testing::ElementsAre("mien a  b", "mien c"));
}

}  // namespace
}  // namespace mien
