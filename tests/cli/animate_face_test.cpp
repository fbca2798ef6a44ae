// mien animate with an imported model: FaceDiffuser on a small mesh.
#include <gmock/gmock.h>

#include "mien/audio/load_audio.h"
#include "mien/io/character_file.h"
#include "mien/io/motion_file.h"
#include "mien/io/npy.h"
#include "mien/models/face_model.h"
#include "program.h"
#include "small_face_model.h"

namespace mien {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class AnimateFaceTest : public ProgramTest {
 protected:
  AnimateFaceTest() {
    write_face_model(in_folder("mesh.safetensors"), face_description(Architecture::facediffuser_v),
                     facediffuser::VertexDenoiser<Tensor>(small_mesh_sizes()));
  }
  // In two rows, with triangles between them.
  static std::string twenty_vertices() {
    std::string obj;
    for (int v = 0; v < 20; ++v) obj += "v " + std::to_string(v % 10) + " " + std::to_string(v / 10) + " 0\n";
    for (int v = 1; v < 10; ++v)
      obj += "f " + std::to_string(v) + " " + std::to_string(v + 1) + " " + std::to_string(v + 10) + "\n";
    return obj;
  }
  [[nodiscard]] Outcome face(std::vector<std::string> more) const {
    more.insert(more.begin(), {"animate", "speech.wav", "--model", "mesh.safetensors"});
    return mien(more);
  }
};

TEST_F(AnimateFaceTest, WritesVerticesByDefault) {
  const auto run = face({"--seed", "3"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("wrote speech.npy"));
  EXPECT_THAT(files(), ElementsAre("mesh.safetensors", "small.safetensors", "speech.npy", "speech.wav"));
  const auto array = read_npy(bytes_of("speech.npy"));
  ASSERT_TRUE(array) << array.error().message();
  EXPECT_THAT(array->shape, ElementsAre(49, 60)) << "2 s at 25 fps, less one";
}

TEST_F(AnimateFaceTest, TheSeedDecidesAndThreadsDoNot) {
  ASSERT_EQ(face({"--seed", "3", "--threads", "1", "-o", "a.npy"}).exit_code, 0);
  ASSERT_EQ(face({"--seed", "3", "--threads", "3", "-o", "b.npy"}).exit_code, 0);
  ASSERT_EQ(face({"--seed", "4", "-o", "c.npy"}).exit_code, 0);
  EXPECT_EQ(bytes_of("a.npy"), bytes_of("b.npy"));
  EXPECT_NE(bytes_of("a.npy"), bytes_of("c.npy"));
}

// What goes to the file block by block is what the library gives at once.
TEST_F(AnimateFaceTest, StreamsTheBitsOfTheMotionInMemory) {
  write_wav("long.wav", syllables(23));
  const auto model = FaceModel::load(in_folder("mesh.safetensors"));
  ASSERT_TRUE(model) << model.error().message();
  const auto clip = load_audio(in_folder("long.wav"));
  ASSERT_TRUE(clip);
  for (const bool windowed : {false, true}) {
    FaceOptions options;
    options.seed = 5;
    std::vector<std::string> words = {
        "animate", "long.wav", "--model", "mesh.safetensors", "--seed", "5", "--takes", "2", "-o", "a.npy"};
    if (windowed) {
      options.windows = EncoderWindows{.frames = 100, .left = 250, .right = 250};
      words.insert(words.end(), {"--window", "2"});
    }
    Progress progress;
    const auto takes = ::mien::animate(*model, *clip, options, 2, 1, progress);
    ASSERT_TRUE(takes) << takes.error().message();
    ASSERT_EQ(mien(words).exit_code, 0);
    for (int take = 0; take < 2; ++take) {
      const auto array = read_npy(bytes_of("a-" + std::to_string(take + 1) + ".npy"));
      ASSERT_TRUE(array) << array.error().message();
      EXPECT_EQ(array->values, (*takes)[static_cast<std::size_t>(take)].values) << take;
    }
  }
  // The same through the interpolation to another rate, and beside an output that keeps the frames.
  write("face.obj", twenty_vertices());
  ASSERT_EQ(face({"--fps", "60", "-o", "b.npy"}).exit_code, 0);
  ASSERT_EQ(face({"--fps", "60", "--mesh", "face.obj", "-o", "c.npy", "-o", "c.glb"}).exit_code, 0);
  EXPECT_EQ(bytes_of("b.npy"), bytes_of("c.npy"));
  EXPECT_EQ(read_npy(bytes_of("b.npy"))->shape.front(), 118) << "49 frames at 25 fps";
}

TEST_F(AnimateFaceTest, RecordingsSideBySideGiveWhatEachGivesAlone) {
  write_wav("one.wav", syllables(1));
  write_wav("six.wav", syllables(6));
  write("letter.wav", "no recording at all");
  const std::vector<std::string> how = {"--model", "mesh.safetensors", "--seed", "5", "--takes", "2"};
  const auto animated = [&](std::vector<std::string> words) {
    words.insert(words.begin(), "animate");
    words.insert(words.end(), how.begin(), how.end());
    return mien(words);
  };
  const auto all = animated({"one.wav", "letter.wav", "six.wav", "-o", "{name}.npy"});
  EXPECT_EQ(all.exit_code, 1);
  EXPECT_THAT(all.err, HasSubstr("1 of 3 recordings: failed: 'letter.wav'"));
  for (const std::string name : {"one", "six"}) {
    ASSERT_EQ(animated({name + ".wav", "-o", "alone.npy"}).exit_code, 0);
    for (const std::string take : {"-1.npy", "-2.npy"})
      EXPECT_EQ(bytes_of(name + take), bytes_of("alone" + take)) << name << take;
  }
}

TEST_F(AnimateFaceTest, AFullDiskIsSaidAndLeavesNothing) {
  write_wav("long.wav", syllables(23));
  const auto before = files();
  const auto run = mien({"animate", "long.wav", "--model", "mesh.safetensors", "-o", "a.npy"},
                        "ulimit -f 60; trap '' XFSZ;");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, HasSubstr("'a.npy': writing failed"));
  EXPECT_EQ(files(), before);
}

TEST_F(AnimateFaceTest, KnowsItsOptions) {
  for (const std::vector<std::string>& more :
       std::vector<std::vector<std::string>>{{"--style", "F1", "--template", "M2"},
                                             {"--subject", "M2", "--skip", "3"},
                                             {"--sampler", "ddim", "--respacing", "ddim4", "--eta", "0.5"},
                                             {"--sampler", "dpm++", "--steps", "4", "--takes", "2"},
                                             {"--precision", "int8", "--window", "0.5"},
                                             {"--const-noise"}}) {
    auto words = more;
    words.insert(words.end(), {"-o", "out.npy"});
    const auto run = face(words);
    EXPECT_EQ(run.exit_code, 0) << run.err;
  }
}

TEST_F(AnimateFaceTest, PutsItsVerticesOnAMesh) {
  write("face.obj", twenty_vertices());
  const auto run = face({"--mesh", "face.obj", "-o", "a.glb", "-o", "a.obj/", "-o", "a.png", "--size", "64"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("49 frames of 20 vertices"));
  const auto glb = load_character(in_folder("a.glb"));
  ASSERT_TRUE(glb) << glb.error().message();
  EXPECT_EQ(glb->parts.front().mesh.positions.size(), 20u);
  EXPECT_FALSE(glb->parts.front().shapes.empty());
  EXPECT_TRUE(std::filesystem::exists(in_folder("a.obj/frame_000048.obj")));
  EXPECT_TRUE(std::filesystem::exists(in_folder("a.png")));
  EXPECT_EQ(face({"--mesh", "absent.obj", "-o", "a.glb"}).exit_code, 3);
  EXPECT_EQ(animate({"--mesh", "face.obj"}).exit_code, 2) << "the default model moves no vertices";
}

TEST_F(AnimateFaceTest, RefusesWhatDoesNotFit) {
  const auto refusal = [&](const std::vector<std::string>& more) {
    const auto run = face(more);
    EXPECT_EQ(run.exit_code, 2) << run.err;
    return run.err;
  };
  EXPECT_THAT(refusal({"-o", "a.csv"}), HasSubstr("vertices"));
  EXPECT_THAT(refusal({"-o", "a.png"}), HasSubstr("triangles"));
  EXPECT_THAT(refusal({"--style", "M9"}), HasSubstr("It knows: F1, M2"));
  EXPECT_THAT(refusal({"--eta", "0.5"}), HasSubstr("ddim"));
  EXPECT_THAT(refusal({"--steps", "4", "--respacing", "4"}), HasSubstr("--respacing"));
  EXPECT_THAT(refusal({"--respacing", "ddim13"}), HasSubstr("ddim13"));
  EXPECT_THAT(refusal({"--skip", "12"}), HasSubstr("--skip"));
  EXPECT_THAT(refusal({"--precision", "int4"}), HasSubstr("f32, bf16, int8"));
  EXPECT_THAT(refusal({"--emotion", "happy"}), HasSubstr("--emotion"));
  const auto other = animate({"--template", "M2"});
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.err, HasSubstr("does not apply"));
}

}  // namespace
}  // namespace mien
