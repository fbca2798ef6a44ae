#include <gmock/gmock.h>

#include "program.h"
#include "test_paths.h"

namespace mien {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST_F(ProgramTest, VersionAndHelpGoToStandardOutput) {
  const auto version = mien({"--version"});
  EXPECT_EQ(version.exit_code, 0);
  EXPECT_EQ(version.out, "mien " MIEN_VERSION "\n");
  for (const std::vector<std::string>& words : {std::vector<std::string>{"--help"},
                                                {"help"},
                                                {"help", "animate"},
                                                {"animate", "--help"},
                                                {"render", "-h"},
                                                {"help", "edit"},
                                                {"help", "fit"},
                                                {"help", "transfer"},
                                                {"help", "inspect"},
                                                {"help", "import"},
                                                {"help", "evaluate"},
                                                {"help", "evaluate", "human"},
                                                {"evaluate", "corpus", "--help"}}) {
    const auto run = mien(words);
    EXPECT_EQ(run.exit_code, 0) << words.back();
    EXPECT_THAT(run.out, HasSubstr("Usage: mien"));
    EXPECT_EQ(run.err, "");
  }
  EXPECT_THAT(mien({"help", "animate"}).out,
              AllOf(HasSubstr("Exit codes"), HasSubstr("Examples"), HasSubstr("--seed")));
}

TEST_F(ProgramTest, NoCommandIsWrongUsage) {
  const auto run = mien({});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_EQ(run.out, "");
  EXPECT_THAT(run.err, HasSubstr("animate"));
}

struct WrongUsage {
  std::vector<std::string> words;
  std::string message;
};

TEST_F(ProgramTest, WrongUsageIsNamed) {
  const std::vector<WrongUsage> cases = {
      {{"anmate", "speech.wav"}, "Did you mean 'mien animate'?"},
      {{"help", "rendr"}, "Did you mean 'mien render'?"},
      {{"frobnicate"},
       "Known: animate, edit, render, inspect, import, evaluate, fit, transfer, data, train, corpus, bench"},
      {{"--verbos"}, "is not known"},
      {{"animate"}, "SPEECH"},
      {{"animate", "speech.wav", "--emotoin", "happy"}, "Did you mean --emotion?"},
      {{"inspect", "a.csv", "other.csv"}, "does not expect 'other.csv'"},
      {{"animate", "speech.wav", "other.wav", "-o", "a.glb"}, "would be written by every recording"},
      {{"animate", "speech.wav", "--emotion", "hapy:2"}, "Did you mean happy?"},
      {{"animate", "speech.wav", "--emotion", "happy:7"}, "intensity '7'"},
      {{"animate", "speech.wav", "--style", "S12"}, "S00 ... S11"},
      {{"animate", "speech.wav", "--sampler", "euler"}, "Known: dpm++, ddim, ddpm"},
      {{"animate", "speech.wav", "--seed", "x"}, "--seed"},
      {{"animate", "speech.wav", "--takes", "0"}, "--takes"},
      {{"animate", "speech.wav", "--steps", "0"}, "--steps"},
      {{"animate", "speech.wav", "--fps", "0"}, "--fps"},
      {{"animate", "speech.wav", "--threads", "-1"}, "--threads"},
      {{"animate", "speech.wav", "--size", "7"}, "--size"},
      {{"animate", "speech.wav", "--view", "behind"}, "--view"},
      {{"animate", "speech.wav", "-o", "a.fbx"}, "Known: .glb, .csv, .json, .npy, .mp4, .webm, .png"},
      {{"animate", "speech.wav", "-o", "a.gbl"}, "Did you mean .glb?"},
      {{"animate", "speech.wav", "-o", "noextension"}, "has no extension"},
      {{"animate", "speech.wav", "-o", "a.glb", "-o", "./a.glb"}, "given twice"},
      {{"render", "a.csv"}, "--output"},
      {{"render", "a.csv", "-o", "a.mov"}, "Known: .glb, .csv, .json, .npy, .mp4, .webm, .png"},
      {{"render", "a.csv", "-o", "a.png", "--times", "1,two"}, "'two' is not a time"},
      {{"render", "a.csv", "-o", "a.png", "--audio", "speech.wav"}, "only videos have sound"},
      {{"render", "a.csv", "-o", "a.png", "--columns", "0"}, "--columns"},
      {{"inspect"}, "FILE"},
      {{"evaluate"}, "mien evaluate"},
      {{"evaluate", "people", "x"}, "people"},
      {{"evaluate", "corpus", "x", "--takes", "1"}, "--takes"},
  };
  for (const auto& [words, message] : cases) {
    std::vector<std::string> all = words;
    if (words.front() == "animate") all.insert(all.end(), {"--model", "small.safetensors"});
    const auto run = mien(all);
    std::string line;
    for (const auto& word : words) line += " " + word;
    EXPECT_EQ(run.exit_code, 2) << line << "\n" << run.err;
    EXPECT_EQ(run.out, "") << line;
    EXPECT_THAT(run.err, HasSubstr(message)) << line;
    EXPECT_THAT(run.err, HasSubstr("error: ")) << line;
  }
  EXPECT_THAT(files(), testing::ElementsAre("small.safetensors", "speech.wav"));
}

TEST_F(ProgramTest, ProgramsThatWereNotBuiltAreNamedWithTheirOption) {
  // A copy of the program in a folder of its own has no companions.
  std::filesystem::copy(built_path("bin/mien"), in_folder("mien"));
  for (const auto& [command, option] :
       {std::pair{"train", "MIEN_TRAIN"}, {"corpus", "MIEN_CORPUS_BUILDER"}, {"bench", "MIEN_BENCH"}}) {
    const auto run = mien({}, "./mien " + std::string(command) + " 2>&1; echo \"code $?\"; false &&");
    EXPECT_THAT(run.out, AllOf(HasSubstr(option), HasSubstr("code 1"))) << command;
  }
}

TEST_F(ProgramTest, CompanionsGetTheArguments) {
  std::filesystem::copy(built_path("bin/mien"), in_folder("mien"));
  write("mien-train", "#!/bin/sh\necho \"trained: $*\"\nexit 5\n");
  const auto run =
      mien({}, "chmod +x mien-train; ./mien train a.toml --device cuda; echo \"code $?\"; false &&");
  EXPECT_THAT(run.out, AllOf(HasSubstr("trained: a.toml --device cuda\n"), HasSubstr("code 5")));
}

}  // namespace
}  // namespace mien
