// What can go wrong in the world: each with its message and exit code, and nothing half written.
#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "program.h"
#include "running_program.h"
#include "test_paths.h"

namespace mien {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class BadInput : public ProgramTest {
 protected:
  // Runs, and expects the exit code, the words in the message and no new file.
  void expect(const std::vector<std::string>& words, int exit_code, const std::string& message,
              const std::string& prelude = "") {
    const auto before = files();
    const auto run = mien(words, prelude);
    EXPECT_EQ(run.exit_code, exit_code) << run.err;
    EXPECT_THAT(run.err, AllOf(HasSubstr("error: "), HasSubstr(message)));
    EXPECT_EQ(run.out, "");
    EXPECT_EQ(files(), before);
  }
  void expect_speech(const std::string& speech, int exit_code, const std::string& message) {
    SCOPED_TRACE(speech);
    expect({"animate", speech, "--model", "small.safetensors", "-o", "out.glb", "-o", "out.csv"}, exit_code,
           message);
  }
};

TEST_F(BadInput, SpeechThatCannotBeAnimated) {
  expect_speech("absent.wav", 3, "not found");
  std::filesystem::create_directory(in_folder("folder.wav"));
  expect_speech("folder.wav", 3, "folder");
  write("empty.wav", "");
  expect_speech("empty.wav", 3, "empty");
  write("letter.wav", "Dear reader, this is a letter and no recording at all.\n");
  expect_speech("letter.wav", 3, "letter.wav");
  write_wav("short.wav", syllables(0.02));
  expect_speech("short.wav", 3, "too short: at least 25 ms");
  const Bytes whole = bytes_of("speech.wav");
  write("cut.wav", as_text(std::span(whole).first(30)));
  expect_speech("cut.wav", 3, "cut.wav");
  write_wav("silent.wav", std::vector<float>(16000, 0.0f));
  expect_speech("silent.wav", 3, "silent");
}

TEST_F(BadInput, SilenceIsAnimatedOnRequest) {
  write_wav("silent.wav", std::vector<float>(16000, 0.0f));
  const auto run =
      mien({"animate", "silent.wav", "--model", "small.safetensors", "--allow-silence", "-o", "a.csv"});
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_THAT(run.err, HasSubstr("warning: the recording is silent"));
}

TEST_F(BadInput, ATruncatedRecordingIsUsedAndSaid) {
  const Bytes whole = bytes_of("speech.wav");
  write("cut.wav", as_text(std::span(whole).first(whole.size() / 2)));
  const auto run = mien({"animate", "cut.wav", "--model", "small.safetensors", "-o", "a.csv"});
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_THAT(run.err, HasSubstr("warning: "));
}

TEST_F(BadInput, NumbersThatAreNoSound) {
  Bytes wav;
  const auto text = [&](std::string_view s) {
    wav.insert(wav.end(), as_bytes(s).begin(), as_bytes(s).end());
  };
  text("RIFF");
  append_le<std::uint32_t>(wav, 36 + 64000);
  text("WAVEfmt ");
  append_le<std::uint32_t>(wav, 16);
  append_le<std::uint16_t>(wav, 3);  // float
  append_le<std::uint16_t>(wav, 1);
  append_le<std::uint32_t>(wav, 16000);
  append_le<std::uint32_t>(wav, 64000);
  append_le<std::uint16_t>(wav, 4);
  append_le<std::uint16_t>(wav, 32);
  text("data");
  append_le<std::uint32_t>(wav, 64000);
  for (int i = 0; i < 16000; ++i)
    append_le<float>(wav, i == 12345 ? std::numeric_limits<float>::quiet_NaN() : 0.1f);
  write("nan.wav", as_text(wav));
  expect_speech("nan.wav", 3, "sample 12345");
}

TEST_F(BadInput, ModelsOfTheWrongKind) {
  const auto with = [](const std::string& model) {
    return std::vector<std::string>{"animate", "speech.wav", "--model", model, "-o", "out.csv"};
  };
  expect(with("absent.safetensors"), 3, "absent.safetensors");
  expect(with("speech.wav"), 3, "speech.wav");
  Bytes broken = bytes_of("small.safetensors");
  broken.resize(broken.size() - 100);
  write("cut.safetensors", as_text(broken));
  expect(with("cut.safetensors"), 3, "cut.safetensors");
  std::string header = R"({"x":{"dtype":"F32","shape":[1],"data_offsets":[0,4]}})";
  Bytes other;
  append_le<std::uint64_t>(other, header.size());
  header.append(4, '\0');
  other.insert(other.end(), as_bytes(header).begin(), as_bytes(header).end());
  write("other.safetensors", as_text(other));
  expect(with("other.safetensors"), 4, "no description of a Mien model");
}

TEST_F(BadInput, CharactersOfTheWrongKind) {
  const auto with = [](const std::string& character) {
    return std::vector<std::string>{"animate", "speech.wav", "--model",     "small.safetensors",
                                    "-o",      "out.glb",    "--character", character};
  };
  expect(with("absent.glb"), 3, "absent.glb");
  expect(with("speech.wav"), 4, "is not a glTF file");
  expect(with("small.safetensors"), 4, "small.safetensors");
  write("plain.gltf", R"({"asset":{"version":"2.0"}})");
  expect(with("plain.gltf"), 4, "plain.gltf");
  write("broken.glb", "glTF but not really");
  expect(with("broken.glb"), 3, "broken.glb");
}

TEST_F(BadInput, BrokenDirection) {
  write("mood.csv", "time,emotion,intensity\n0,happy,0.5\n1,grumpy,0.5\n");
  expect({"animate", "speech.wav", "--model", "small.safetensors", "--emotion", "mood.csv"}, 3, "line 3");
  expect({"animate", "speech.wav", "--model", "small.safetensors", "--emotion", "absent.csv"}, 3,
         "absent.csv");
}

TEST_F(BadInput, OutputsThatCannotBeWritten) {
  const auto to = [](const std::string& output) {
    return std::vector<std::string>{"animate", "speech.wav", "--model", "small.safetensors", "-o", output};
  };
  expect(to("absent/out.glb"), 1, "absent/out.glb");
  expect({"animate", "speech.wav", "--model", "small.safetensors", "-o", "good.csv", "-o", "absent/out.csv"},
         1,
         "absent/out.csv");  // seen before the first one is written
  std::filesystem::create_directory(in_folder("taken.csv"));
  expect(to("taken.csv"), 1, "is a folder");
  write("file", "x");
  expect(to("file/"), 1, "is a file");
  expect(to("/proc/out.csv"), 1, "/proc/out.csv");
  std::filesystem::copy(in_folder("small.safetensors"), in_folder("m.json"));
  expect({"animate", "speech.wav", "--model", "m.json", "-o", "m.json"}, 2, "is an input");
}

// A limit on the size of files stands for a full disk: the write fails in the middle.
TEST_F(BadInput, AFullDiskLeavesNothingBehind) {
  const std::string full = "ulimit -f 40; trap '' XFSZ;";  // 40 KiB
  const std::vector<std::string> start = {"animate", "speech.wav", "--model", "small.safetensors", "-o"};
  for (const char* output : {"out.glb", "out.csv", "out.json"}) {
    SCOPED_TRACE(output);
    auto words = start;
    words.emplace_back(output);
    expect(words, 1, "writing failed", full);
  }
  auto film = start;
  film.insert(film.end(), {"out.mp4", "--size", "512", "--fps", "60"});
  expect(film, 1, "out.mp4", full);
}

TEST_F(BadInput, MotionsThatCannotBeRendered) {
  expect({"render", "absent.csv", "-o", "a.png"}, 3, "absent.csv");
  expect({"render", "speech.wav", "-o", "a.png"}, 2, "speech.wav");
  write("words.csv", "one,two\n1,2\n");
  expect({"render", "words.csv", "-o", "a.png"}, 4, "words.csv");
  write("words.json", "[1, 2]");
  expect({"render", "words.json", "-o", "a.png"}, 4, "words.json");
}

TEST_F(BadInput, FilesThatCannotBeInspected) {
  expect({"inspect", "absent.wav"}, 3, "absent.wav");
  expect({"inspect", "absent.safetensors"}, 3, "absent.safetensors");
  write("broken.glb", "glTF");
  expect({"inspect", "broken.glb"}, 3, "broken.glb");
}

// Interrupted before the work and in the middle of it: always after a sign of life, never after a fixed time.
TEST_F(BadInput, AnInterruptEndsCleanly) {
  write_wav("long.wav", syllables(600));
  const auto before = files();
  for (const char* sign : {R"("type":"start")", R"("type":"progress")"}) {
    for (const int signal : {SIGINT, SIGTERM}) {
      SCOPED_TRACE(sign);
      RunningProgram run(built_path("bin/mien").string(),
                         {"animate", "long.wav", "--model", "small.safetensors", "--steps", "1000", "--json",
                          "-o", "out.csv"},
                         in_folder(""));
      ASSERT_TRUE(run.says(sign)) << run.err();
      run.send(signal);
      EXPECT_EQ(run.wait(), 130) << run.err();
      EXPECT_THAT(run.err(), HasSubstr(R"("why":"interrupted")"));
      EXPECT_EQ(files(), before);
    }
  }
}

}  // namespace
}  // namespace mien
