// mien animate with several recordings: each gets its outputs, and one that fails takes no other with it.
#include <gmock/gmock.h>

#include <algorithm>

#include "mien/io/motion_file.h"
#include "program.h"

namespace mien {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class Several : public ProgramTest {
 protected:
  Several() {
    write_wav("a.wav", syllables(1));
    write_wav("b.wav", syllables(1.5));
  }
  [[nodiscard]] Outcome run(std::vector<std::string> speech, const std::vector<std::string>& more) const {
    std::vector<std::string> words = {"animate", "--model", "small.safetensors"};
    words.insert(words.end(), speech.begin(), speech.end());
    words.insert(words.end(), more.begin(), more.end());
    return mien(words);
  }
  [[nodiscard]] bool has(const std::string& name) const { return std::filesystem::exists(in_folder(name)); }
};

TEST_F(Several, EachGetsWhatItGetsAlone) {
  const auto all = run({"a.wav", "b.wav"}, {"-o", "{name}.csv", "-o", "x-{name}.npy", "--seed", "3"});
  ASSERT_EQ(all.exit_code, 0) << all.err;
  EXPECT_THAT(all.err, AllOf(HasSubstr("wrote a.csv, x-a.npy: 1.00 s"), HasSubstr("wrote b.csv, x-b.npy"),
                             HasSubstr("wrote 2 recordings: 2.50 s")));
  for (const std::string name : {"a", "b"}) {
    ASSERT_EQ(run({name + ".wav"}, {"-o", "alone.csv", "-o", "alone.npy", "--seed", "3"}).exit_code, 0);
    EXPECT_EQ(bytes_of(name + ".csv"), bytes_of("alone.csv"));
    EXPECT_EQ(bytes_of("x-" + name + ".npy"), bytes_of("alone.npy"));
  }
}

TEST_F(Several, AFolderGetsAFileOfEach) {
  ASSERT_EQ(run({"a.wav", "b.wav"}, {"-o", "new/faces/", "--takes", "2"}).exit_code, 0);
  for (const char* name :
       {"new/faces/a-1.glb", "new/faces/a-2.glb", "new/faces/b-1.glb", "new/faces/b-2.glb"})
    EXPECT_TRUE(has(name)) << name;
  ASSERT_EQ(run({"a.wav", "b.wav"}, {"-o", "new"}).exit_code, 0) << "a folder that is there needs no slash";
  EXPECT_TRUE(has("new/a.glb") && has("new/b.glb"));
  ASSERT_EQ(run({"a.wav", "b.wav"}, {}).exit_code, 0);
  EXPECT_TRUE(has("a.glb") && has("b.glb"));
  ASSERT_EQ(run({"a.wav"}, {"-o", "one-{name}.csv"}).exit_code, 0);
  EXPECT_TRUE(has("one-a.csv"));
}

TEST_F(Several, OneThatFailsDoesNotStopTheOthers) {
  write("letter.wav", "Dear reader, this is a letter and no recording at all.\n");
  write_wav("silent.wav", std::vector<float>(16000, 0.0f));
  const auto some =
      run({"a.wav", "absent.wav", "letter.wav", "silent.wav", "b.wav"}, {"-o", "out/", "-o", "{name}.csv"});
  EXPECT_EQ(some.exit_code, 1) << some.err;
  EXPECT_THAT(some.err,
              AllOf(HasSubstr("error: 'absent.wav': file not found"), HasSubstr("letter.wav"),
                    HasSubstr("the recording is silent"),
                    HasSubstr("3 of 5 recordings: failed: 'absent.wav', 'letter.wav', 'silent.wav'")));
  EXPECT_TRUE(has("out/a.glb") && has("out/b.glb") && has("a.csv") && has("b.csv"));
  EXPECT_FALSE(has("silent.csv") || has("out/silent.glb") || has("letter.csv"));

  const auto events = run({"a.wav", "absent.wav"}, {"-o", "{name}.csv", "--json"}).events();
  ASSERT_GE(events.size(), 4u);
  EXPECT_EQ(events.front()["inputs"].size(), 2u);
  const auto of_type = [&](const char* type) {
    return std::find_if(events.begin(), events.end(), [&](const auto& e) { return e["type"] == type; });
  };
  ASSERT_TRUE(of_type("clip") != events.end() && of_type("clip_failed") != events.end());
  EXPECT_EQ((*of_type("clip"))["input"], "a.wav");
  EXPECT_EQ((*of_type("clip"))["outputs"][0], "a.csv");
  EXPECT_EQ((*of_type("clip_failed"))["input"], "absent.wav");
  EXPECT_EQ((*of_type("clip_failed"))["exit_code"], 3);
  EXPECT_EQ(events.back()["type"], "failure");
  EXPECT_EQ(events.back()["exit_code"], 1);
}

TEST_F(Several, OutputsThatWouldMeetAreRefused) {
  const auto refusal = [&](const std::vector<std::string>& speech, const std::string& output) {
    const auto refused = run(speech, {"-o", output});
    EXPECT_EQ(refused.exit_code, 2) << refused.err;
    return refused.err;
  };
  EXPECT_THAT(refusal({"a.wav", "b.wav"}, "one.glb"),
              AllOf(HasSubstr("would be written by every recording"), HasSubstr("'{name}.glb'")));
  std::filesystem::create_directory(in_folder("other"));
  std::filesystem::copy(in_folder("a.wav"), in_folder("other/a.wav"));
  EXPECT_THAT(refusal({"a.wav", "other/a.wav"}, "{name}.csv"),
              AllOf(HasSubstr("would be written by 'a.wav'"), HasSubstr("'other/a.wav'")));
  EXPECT_THAT(refusal({"a.wav", "b.wav"}, "{name}.wav"), HasSubstr(".wav"));
  EXPECT_FALSE(has("a.csv"));
  const auto unknown = run({"a.wav", "b.wav"}, {"--style", "S99"});
  EXPECT_EQ(unknown.exit_code, 2) << "a wrong word is said once";
}

}  // namespace
}  // namespace mien
