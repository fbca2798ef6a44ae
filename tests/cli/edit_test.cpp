// mien edit: what is kept, what is refused.
#include <gmock/gmock.h>

#include "mien/core/arkit.h"
#include "mien/io/motion_file.h"
#include "program.h"
#include "small_face_model.h"

namespace mien {
namespace {

using testing::HasSubstr;

class EditProgramTest : public ProgramTest {
 protected:
  EditProgramTest() {
    const auto run = animate({"-o", "hello.csv", "-o", "hello.json", "-o", "hello.npy", "-o", "hello.glb"});
    EXPECT_EQ(run.exit_code, 0) << run.err;
  }
  [[nodiscard]] Outcome edit(std::vector<std::string> more, const std::string& motion = "hello.json") const {
    more.insert(more.begin(), {"edit", motion, "--speech", "speech.wav", "--model", "small.safetensors"});
    return mien(more);
  }
  [[nodiscard]] Motion motion(const std::string& name) const {
    auto read = read_motion(in_folder(name));
    EXPECT_TRUE(read) << name << read.error().message();
    return read ? *read : Motion{};
  }
  [[nodiscard]] std::string refusal(const std::vector<std::string>& more, int exit_code) const {
    auto words = more;
    words.insert(words.end(), {"-o", "refused.json"});
    const auto run = edit(words);
    EXPECT_EQ(run.exit_code, exit_code) << run.err;
    EXPECT_FALSE(std::filesystem::exists(in_folder("refused.json")));
    return run.err;
  }
};

// Frames first ... end - 1 of two motions, or all others, are equal.
void expect_equal_outside(const Motion& a, const Motion& b, std::int64_t first, std::int64_t end) {
  ASSERT_EQ(a.values.size(), b.values.size());
  ASSERT_EQ(a.channels, b.channels);
  int differ = 0;
  for (std::int64_t n = 0; n < a.num_frames(); ++n)
    for (std::size_t c = 0; c < static_cast<std::size_t>(a.num_channels()); ++c) {
      if (n < first || n >= end) {
        ASSERT_EQ(a.frame(n)[c], b.frame(n)[c]) << n << " " << a.channel_name(static_cast<std::int64_t>(c));
      } else {
        differ += a.frame(n)[c] != b.frame(n)[c];
      }
    }
  EXPECT_GT(differ, 100);
}

TEST_F(EditProgramTest, WhatIsKeptReadsBackTheSameInEveryFormat) {
  for (const std::string extension : {".csv", ".json", ".npy", ".glb"}) {
    const auto run = edit({"--range", "0.5-1.25", "-o", "again" + extension}, "hello" + extension);
    ASSERT_EQ(run.exit_code, 0) << extension << run.err;
    const Motion before = motion("hello" + extension);
    Motion after = motion("again" + extension);
    if (extension == ".glb") {  // the head's angles are a rotation there, the curves are kept as they are
      for (std::int64_t n = 0; n < after.num_frames(); ++n)
        for (std::size_t c = 52; c < after.channels.size(); ++c)
          if (n < 30 || n >= 76) {
            EXPECT_NEAR(after.frame(n)[c], before.frame(n)[c], 1e-4);
            after.frame(n)[c] = before.frame(n)[c];
          }
    }
    expect_equal_outside(before, after, 30, 76);
  }
}

TEST_F(EditProgramTest, SaysWhatItWrote) {
  const auto run = edit({"--range", "0.5-1.25", "--takes", "2", "--seed", "5", "-o", "again.json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.out, "");
  EXPECT_THAT(run.err, HasSubstr("wrote again-1.json, again-2.json: new between 0.500 and 1.250 s"));
  EXPECT_THAT(run.err, HasSubstr("seed 5"));
  const Motion before = motion("hello.json"), one = motion("again-1.json"), two = motion("again-2.json");
  expect_equal_outside(before, one, 30, 76);
  expect_equal_outside(before, two, 30, 76);
  EXPECT_NE(one.values, two.values);
  const auto json = edit({"--range", "0.5-1.25", "-o", "again.json", "--json"}).events();
  ASSERT_FALSE(json.empty());
  EXPECT_EQ(json.front().at("command"), "edit");
  EXPECT_EQ(json.back().at("takes"), 1);
  EXPECT_NEAR(json.back().at("edited_to").get<double>(), 1.25, 1e-3);
}

TEST_F(EditProgramTest, TheSeedDecidesAndThreadsDoNot) {
  ASSERT_EQ(edit({"--range", "0.5-1.25", "--threads", "1", "-o", "a.json"}).exit_code, 0);
  ASSERT_EQ(edit({"--range", "0.5-1.25", "--threads", "3", "-o", "b.json"}).exit_code, 0);
  ASSERT_EQ(edit({"--range", "0.5-1.25", "--seed", "1", "-o", "c.json"}).exit_code, 0);
  EXPECT_EQ(bytes_of("a.json"), bytes_of("b.json"));
  EXPECT_NE(bytes_of("a.json"), bytes_of("c.json"));
}

TEST_F(EditProgramTest, OverlappingRangesAreOneStretch) {
  ASSERT_EQ(edit({"--range", "0.5-1", "--range", "0.75-1.25", "-o", "a.json"}).exit_code, 0);
  ASSERT_EQ(edit({"--range", "0.5-1.25", "-o", "b.json"}).exit_code, 0);
  EXPECT_EQ(bytes_of("a.json"), bytes_of("b.json"));
}

TEST_F(EditProgramTest, LocksMasksAndKeysAreHonoured) {
  const Motion before = motion("hello.json");
  const std::int64_t jaw = *before.find("jawOpen"), smile = *before.find("mouthSmileRight");
  const auto same = [&](const Motion& after, std::int64_t c) {
    for (std::int64_t n = 0; n < before.num_frames(); ++n)
      if (after.frame(n)[static_cast<std::size_t>(c)] != before.frame(n)[static_cast<std::size_t>(c)])
        return false;
    return true;
  };
  ASSERT_EQ(edit({"--lock", "jawOpen,mouthSmile*", "-o", "locked.json"}).exit_code, 0);
  const Motion locked = motion("locked.json");
  EXPECT_TRUE(same(locked, jaw));
  EXPECT_TRUE(same(locked, smile));
  EXPECT_NE(locked.values, before.values);

  write("keys.csv", "time,channel,value\n1.0,browInnerUp,0.625\n0.5,headYaw,-7.5\n1.5,jawOpen,\n");
  ASSERT_EQ(edit({"--keep-keys", "keys.csv", "--range", "0.25-1.75", "-o", "keyed.json"}).exit_code, 0);
  const Motion keyed = motion("keyed.json");
  EXPECT_EQ(keyed.frame(60)[static_cast<std::size_t>(*before.find("browInnerUp"))], 0.625f);
  EXPECT_EQ(keyed.frame(30)[static_cast<std::size_t>(*before.find("headYaw"))], -7.5f);
  EXPECT_EQ(keyed.frame(90)[static_cast<std::size_t>(jaw)], before.frame(90)[static_cast<std::size_t>(jaw)]);

  const auto pucker = *before.find("mouthPucker");  // moves in both halves
  std::string mask = "mouthPucker,browInnerUp\n";
  for (int n = 0; n < 120; ++n) mask += n < 60 ? "1,0\n" : "0,0\n";
  write("mask.csv", mask);
  const auto run = edit({"--mask", "mask.csv", "-o", "masked.json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("does not name 53 of the 55 channels: they are kept"));
  const Motion masked = motion("masked.json");
  EXPECT_TRUE(same(masked, smile));
  EXPECT_FALSE(same(masked, pucker));
  for (std::int64_t n = 0; n < 60; ++n)
    ASSERT_EQ(masked.frame(n)[static_cast<std::size_t>(pucker)],
              before.frame(n)[static_cast<std::size_t>(pucker)]);
}

TEST_F(EditProgramTest, RefusesWrongWords) {
  EXPECT_THAT(refusal({}, 2), HasSubstr("--range, --lock, --mask or --keep-keys"));
  EXPECT_THAT(refusal({"--range", "1.5-1"}, 2), HasSubstr("ends before it starts"));
  EXPECT_THAT(refusal({"--range", "3-4"}, 2), HasSubstr("beyond the end of the motion at 2.000 s"));
  EXPECT_THAT(refusal({"--range", "1.505-1.51"}, 2), HasSubstr("no frame"));
  EXPECT_THAT(refusal({"--range", "soon"}, 2), HasSubstr("1.20-2.05"));
  EXPECT_THAT(refusal({"--lock", "jawOpne"}, 2), HasSubstr("Did you mean jawOpen?"));
  EXPECT_THAT(refusal({"--lock", "ear*"}, 2), HasSubstr("It has: "));
  EXPECT_THAT(refusal({"--lock", "*"}, 2), HasSubstr("everything is kept"));
  EXPECT_THAT(refusal({"--range", "0-1", "--style", "S99"}, 2), HasSubstr("--style"));
  EXPECT_THAT(refusal({"--range", "0-1", "--emotion", "hapy"}, 2), HasSubstr("Did you mean happy?"));
  EXPECT_THAT(refusal({"--range", "0-1", "--takes", "0"}, 2), HasSubstr("--takes"));
  EXPECT_EQ(edit({"--range", "0-1", "-o", "hello.json"}).exit_code, 2) << "an input";
  EXPECT_EQ(edit({"--range", "0-1"}).exit_code, 2) << "no output";
  EXPECT_EQ(mien({"edit", "hello.json", "--range", "0-1", "-o", "a.json"}).exit_code, 2) << "no speech";
}

TEST_F(EditProgramTest, RefusesFilesThatAreMissingBrokenOrDoNotFit) {
  EXPECT_EQ(edit({"--range", "0-1", "-o", "a.json"}, "absent.json").exit_code, 3);
  EXPECT_EQ(
      mien({"edit", "hello.json", "--speech", "absent.wav", "--range", "0-1", "-o", "a.json"}).exit_code, 3);
  EXPECT_THAT(refusal({"--mask", "absent.csv"}, 3), HasSubstr("absent.csv"));
  write("broken.csv", "jawOpen\n2\n");
  EXPECT_THAT(refusal({"--mask", "broken.csv"}, 3), HasSubstr("line 2"));
  EXPECT_THAT(refusal({"--keep-keys", "broken.csv"}, 3), HasSubstr("time,channel,value"));
  write("short.csv", "jawOpen\n1\n0\n");
  EXPECT_THAT(refusal({"--mask", "short.csv"}, 4), HasSubstr("2 lines, the motion 120 frames"));
  write("late.csv", "time,channel,value\n2.5,jawOpen,0\n");
  EXPECT_THAT(refusal({"--keep-keys", "late.csv"}, 4), HasSubstr("beyond the end"));
  write("unknown.csv", "time,channel,value\n0.5,jawOpenn,0\n");
  EXPECT_THAT(refusal({"--keep-keys", "unknown.csv"}, 4), HasSubstr("Did you mean jawOpen?"));
  write("outside.csv", "time,channel,value\n0.5,jawOpen,0.9\n");
  EXPECT_THAT(refusal({"--keep-keys", "outside.csv", "--range", "1-1.5"}, 4), HasSubstr("outside of what"));
  write("twice.csv", "time,channel,value\n0.5,jawOpen,0.9\n0.5,jawOpen,0.8\n");
  EXPECT_THAT(refusal({"--keep-keys", "twice.csv"}, 4), HasSubstr("another key"));
  write_wav("longer.wav", syllables(3));
  const auto run = mien({"edit", "hello.json", "--speech", "longer.wav", "--model", "small.safetensors",
                         "--range", "0-1", "-o", "a.json"});
  EXPECT_EQ(run.exit_code, 4);
  EXPECT_THAT(run.err, HasSubstr("lasts 2.00 s, the speech 3.00 s"));
}

// FaceDiffuser on a mesh of 100 vertices: the fewest that an .npy is read as vertices with.
class EditFaceProgramTest : public ProgramTest {
 protected:
  EditFaceProgramTest() {
    ModelFile description = face_description(Architecture::facediffuser_v);
    facediffuser::Sizes sizes = small_mesh_sizes();
    description.output.channels = sizes.num_channels = 300;
    write_face_model(in_folder("mesh.safetensors"), description, facediffuser::VertexDenoiser<Tensor>(sizes));
    const auto run =
        mien({"animate", "speech.wav", "--model", "mesh.safetensors", "-o", "face.npy", "--steps", "4"});
    EXPECT_EQ(run.exit_code, 0) << run.err;
  }
  [[nodiscard]] Outcome edit(std::vector<std::string> more) const {
    more.insert(more.begin(), {"edit", "face.npy", "--motion-fps", "25", "--speech", "speech.wav", "--model",
                               "mesh.safetensors"});
    return mien(more);
  }
};

TEST_F(EditFaceProgramTest, KeepsFramesAndLockedVertices) {
  write("region.txt", "0, 1, 2, 19\n");
  const auto run =
      edit({"--range", "0.4-1.2", "--lock", "region.txt", "--steps", "4", "--takes", "2", "-o", "again.npy"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto before = read_motion(in_folder("face.npy"), {.fps = 25}),
             after = read_motion(in_folder("again-2.npy"), {.fps = 25});
  ASSERT_TRUE(before && after);
  expect_equal_outside(*before, *after, 10, 31);
  for (std::int64_t n = 10; n < 31; ++n)
    for (const std::size_t v : {0u, 1u, 2u, 19u})
      for (std::size_t axis = 0; axis < 3; ++axis)
        ASSERT_EQ(after->frame(n)[3 * v + axis], before->frame(n)[3 * v + axis]) << n << " " << v;
}

TEST_F(EditFaceProgramTest, RefusesWhatDoesNotFit) {
  const auto no_region = edit({"--lock", "mouth", "-o", "a.npy"});
  EXPECT_EQ(no_region.exit_code, 2);
  EXPECT_THAT(no_region.err, HasSubstr("neither a region of the model nor a file"));
  write("far.txt", "0, 100\n");
  EXPECT_EQ(edit({"--lock", "far.txt", "-o", "a.npy"}).exit_code, 4);
  write("keys.csv", "time,channel,value\n0.5,jawOpen,0\n");
  EXPECT_THAT(edit({"--keep-keys", "keys.csv", "-o", "a.npy"}).err, HasSubstr("no named channels"));
  const auto curves = mien({"edit", "face.npy", "--speech", "speech.wav", "--model", "small.safetensors",
                            "--range", "0-0.5", "-o", "a.npy"});
  EXPECT_EQ(curves.exit_code, 4);
  EXPECT_THAT(curves.err, HasSubstr("300 channels"));
}

}  // namespace
}  // namespace mien
