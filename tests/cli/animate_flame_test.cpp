// mien animate with ProbTalk3D: FLAME parameters, and the face that a FLAME model makes of them.
#include <gmock/gmock.h>

#include "made_flame.h"
#include "mien/base/file.h"
#include "mien/io/character_file.h"
#include "mien/io/gltf_writer.h"
#include "mien/io/mesh_file.h"
#include "mien/io/motion_file.h"
#include "mien/io/npy.h"
#include "mien/models/probtalk3d/conventions.h"
#include "mien/models/probtalk3d/network.h"
#include "mien/render/png.h"
#include "program.h"
#include "sheet_face.h"
#include "small_face_model.h"
#include "test_paths.h"

namespace mien {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class AnimateFlameTest : public ProgramTest {
 protected:
  AnimateFlameTest() {
    ModelFile m;
    m.architecture = Architecture::probtalk3d;
    m.name = "small";
    m.encoder = small_face_encoder();
    m.output = {.space = "flame", .channels = 53, .fps = 25, .topology = "flame"};
    m.scaler = probtalk3d::published_scaler();
    m.sizes["heads"] = 2;
    m.subjects = {"M003", "W028"};
    m.emotions = probtalk3d::published_emotions();
    m.intensities = probtalk3d::published_intensities();
    probtalk3d::Sizes sizes;
    sizes.width = 8, sizes.inner = 12, sizes.heads = 2, sizes.prior_blocks = 1, sizes.num_codes = 16;
    sizes.code_width = 4, sizes.predictor_blocks = 1, sizes.condition = 32, sizes.style = 13;
    write_face_model(in_folder("flame.safetensors"), m, probtalk3d::Network<Tensor>(sizes));
  }
  void write_glb_file(const std::string& name, const Character& character) const {
    const auto glb = write_glb(character, {});
    ASSERT_TRUE(glb) << glb.error().message();
    ASSERT_TRUE(write_file(in_folder(name), std::span<const std::byte>(*glb)));
  }
  // A rig and a model in FLAME's form of one topology.
  void write_rig() const {
    const Character rig = sheet_face(11, 11);
    write_glb_file("rig.glb", rig);
    write("made.pkl", flame_pickle(made_flame(rig.parts.front().mesh, rig.parts.front().shapes, 50)));
  }
  [[nodiscard]] Outcome face(std::vector<std::string> more) const {
    more.insert(more.begin(), {"animate", "speech.wav", "--model", "flame.safetensors"});
    return mien(more);
  }
};

TEST_F(AnimateFlameTest, WritesParametersAndSaysSo) {
  const auto run = face({"--style", "W028", "--emotion", "happy:3", "--seed", "3"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("53 FLAME parameters"));
  EXPECT_THAT(run.err, HasSubstr("--flame"));
  const auto layout = read_npy_layout(bytes_of("speech.npy"));
  ASSERT_TRUE(layout) << layout.error().message();
  EXPECT_THAT(layout->shape, ElementsAre(1, 49, 403)) << "two features a frame of 2 s";
  EXPECT_EQ(layout->item_size, 8u);
  const auto motion = read_motion(in_folder("speech.npy"));
  ASSERT_TRUE(motion) << motion.error().message();
  EXPECT_EQ(motion->space, MotionSpace::flame);
}

TEST_F(AnimateFlameTest, TakesAreThoseOfTheirSeedsOnAnyNumberOfThreads) {
  ASSERT_EQ(face({"--takes", "3", "--temperature", "5", "--threads", "1", "-o", "a.npy"}).exit_code, 0);
  ASSERT_EQ(face({"--takes", "3", "--temperature", "5", "--threads", "3", "-o", "b.npy", "-o", "b.csv", "-o",
                  "b.json"})
                .exit_code,
            0);
  for (const char* take : {"-1.npy", "-2.npy", "-3.npy"})
    EXPECT_EQ(bytes_of("a" + std::string(take)), bytes_of("b" + std::string(take)));
  EXPECT_NE(bytes_of("a-1.npy"), bytes_of("a-2.npy"));
  const auto csv = read_motion(in_folder("b-1.csv")), json = read_motion(in_folder("b-1.json"));
  ASSERT_TRUE(csv && json);
  EXPECT_EQ(csv->values, json->values);
  EXPECT_EQ(csv->channels, json->channels);
  ASSERT_EQ(face({"--takes", "2", "--temperature", "0", "-o", "still.npy"}).exit_code, 0);
  EXPECT_EQ(bytes_of("still-1.npy"), bytes_of("still-2.npy")) << "the nearest codes are always the same";
}

// With the recorded model, which has the layout of the published file.
TEST_F(AnimateFlameTest, MakesAFaceWithAFlameModel) {
  const std::filesystem::path recorded = shared_path("fixtures/probtalk3d/flame_synthetic.pkl");
  if (!std::filesystem::exists(recorded)) GTEST_SKIP() << "no recorded FLAME model";
  const auto run = face({"--flame", recorded.string(), "-o", "face.npy", "-o", "face.glb", "-o", "face.png",
                         "-o", "face.csv", "--size", "64"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto vertices = read_npy_layout(bytes_of("face.npy"));
  ASSERT_TRUE(vertices);
  EXPECT_EQ(vertices->shape.front(), 49);
  EXPECT_EQ(read_motion(in_folder("face.csv"))->space, MotionSpace::flame);
  const auto glb = load_character(in_folder("face.glb"));
  ASSERT_TRUE(glb) << glb.error().message();
  EXPECT_EQ(glb->parts.front().mesh.positions.size(), 60u);
  EXPECT_FALSE(glb->parts.front().mesh.triangles.empty());
  // From the parameters in the file the same face is made.
  const auto later = mien({"render", "face.csv", "--flame", recorded.string(), "-o", "later.npy"});
  ASSERT_EQ(later.exit_code, 0) << later.err;
  EXPECT_EQ(read_motion(in_folder("later.npy"))->values, read_motion(in_folder("face.npy"))->values);
  const auto without = mien({"render", "face.csv", "-o", "later.png"});
  EXPECT_EQ(without.exit_code, 2);
  EXPECT_THAT(without.err, HasSubstr("--flame"));
  EXPECT_EQ(mien({"render", "face.npy", "--flame", recorded.string(), "-o", "later.png"}).exit_code, 2);
}

// Curves of a rig on FLAME's topology, by one command and by two.
TEST_F(AnimateFlameTest, MovesACharacterOfItsTopology) {
  write_rig();
  const auto run =
      face({"--flame", "made.pkl", "--character", "rig.glb", "--takes", "2", "--temperature", "5", "-o",
            "out.csv", "-o", "out.json", "-o", "out.glb", "-o", "out.png", "--size", "32", "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("\"residual_mm\""));
  const auto motion = read_motion(in_folder("out-2.json"));
  ASSERT_TRUE(motion) << motion.error().message();
  EXPECT_EQ(motion->space, MotionSpace::arkit);
  EXPECT_THAT(motion->channels, ElementsAre("jawOpen", "mouthSmileLeft", "browInnerUp")) << "no gaze";
  EXPECT_EQ(motion->fps, 60);
  EXPECT_EQ(motion->num_frames(), num_motion_frames(49.0 / 25, 60));
  const auto animated = read_motion(in_folder("out-2.glb"));
  ASSERT_TRUE(animated) << animated.error().message();
  EXPECT_EQ(animated->num_frames(), motion->num_frames());
  EXPECT_GT(bytes_of("out-1.png").size(), 100u);

  ASSERT_EQ(face({"--takes", "2", "--temperature", "5", "-o", "parameters.npy"}).exit_code, 0);
  const auto two =
      mien({"fit", "parameters-2.npy", "--flame", "made.pkl", "--character", "rig.glb", "-o", "two.json"});
  ASSERT_EQ(two.exit_code, 0) << two.err;
  const auto same = read_motion(in_folder("two.json"));
  ASSERT_TRUE(same) << same.error().message();
  ASSERT_EQ(same->values.size(), motion->values.size());
  for (std::size_t i = 0; i < same->values.size(); ++i) EXPECT_NEAR(same->values[i], motion->values[i], 1e-5);
}

// By the rig's coefficients, a face of any other topology.
TEST_F(AnimateFlameTest, MovesAnyCharacterThroughTheRig) {
  write_rig();
  write_glb_file("hero.glb", sheet_face(7, 9));
  const auto alone = face({"--flame", "made.pkl", "--character", "hero.glb", "-o", "hero.out.glb"});
  EXPECT_EQ(alone.exit_code, 4);
  EXPECT_THAT(alone.err, HasSubstr("--flame-rig"));
  const auto run = face({"--flame", "made.pkl", "--flame-rig", "rig.glb", "--character", "hero.glb", "--fps",
                         "30", "-o", "hero.out.glb", "-o", "curves.csv", "-o", "hero.out.npy"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto moved = load_character(in_folder("hero.out.glb"));
  ASSERT_TRUE(moved) << moved.error().message();
  EXPECT_EQ(moved->parts.front().mesh.positions.size(), 63u);
  const auto curves = read_motion(in_folder("curves.csv"));
  ASSERT_TRUE(curves) << curves.error().message();
  EXPECT_EQ(curves->num_frames(), num_motion_frames(49.0 / 25, 30));
  EXPECT_EQ(face({"--flame-rig", "rig.glb", "-o", "a.csv"}).exit_code, 2);
  EXPECT_EQ(face({"--character", "rig.glb", "-o", "a.csv"}).exit_code, 2) << "no FLAME model";
  EXPECT_EQ(face({"--flame", "made.pkl", "--flame-rig", "hero.glb", "-o", "a.csv"}).exit_code, 4);
  EXPECT_EQ(animate({"--flame-rig", "rig.glb"}).exit_code, 2);
}

// All emotions of the model in one picture: a row each.
TEST_F(AnimateFlameTest, ShowsItsEmotionsTogether) {
  write_rig();
  for (const std::vector<std::string>& more :
       {std::vector<std::string>{"-o", "vertices.png"}, {"--character", "rig.glb", "-o", "curves.png"}}) {
    std::vector<std::string> words = {"--flame", "made.pkl", "--emotions", "all:3",
                                      "--times", "0.5,1",    "--size",     "40"};
    words.insert(words.end(), more.begin(), more.end());
    const auto run = face(words);
    ASSERT_EQ(run.exit_code, 0) << run.err;
    const auto picture = read_png(in_folder(more.back()));
    ASSERT_TRUE(picture);
    EXPECT_EQ(picture->height(), 12 + 8 * 42);
  }
  EXPECT_EQ(face({"--emotions", "all:4", "--flame", "made.pkl", "-o", "a.png"}).exit_code, 2);
}

TEST_F(AnimateFlameTest, MovesAnotherFaceOfItsTopology) {
  write_rig();
  Mesh other = sheet_face(11, 11).parts.front().mesh;
  for (Vec3& p : other.positions) p.z += 0.5f;
  write("other.obj", write_obj(other));
  const auto with = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words = {"--flame", "made.pkl"};
    words.insert(words.end(), more.begin(), more.end());
    return face(words).exit_code;
  };
  ASSERT_EQ(with({"-o", "own.npy"}), 0);
  ASSERT_EQ(with({"--face", "other.obj", "-o", "other.npy", "-o", "other.glb"}), 0);
  const auto own = read_motion(in_folder("own.npy")), moved = read_motion(in_folder("other.npy"));
  ASSERT_TRUE(own && moved);
  for (std::size_t i = 0; i < own->values.size(); ++i)
    EXPECT_NEAR(moved->values[i], own->values[i] + (i % 3 == 2 ? 0.5f : 0.0f), 1e-6);
  EXPECT_EQ(with({"--face", "other.obj", "--character", "rig.glb", "-o", "a.glb"}), 2);
}

TEST_F(AnimateFlameTest, RefusesWhatDoesNotFit) {
  const auto refusal = [&](const std::vector<std::string>& more, int code) {
    const auto run = face(more);
    EXPECT_EQ(run.exit_code, code) << run.err;
    return run.err;
  };
  EXPECT_THAT(refusal({"-o", "a.glb"}, 2), HasSubstr("--flame"));
  EXPECT_THAT(refusal({"-o", "a.png"}, 2), HasSubstr("--flame"));
  EXPECT_THAT(refusal({"--skip", "3"}, 2), HasSubstr("no diffusion"));
  EXPECT_THAT(refusal({"--sampler", "ddim"}, 2), HasSubstr("--sampler"));
  EXPECT_THAT(refusal({"--template", "M003"}, 2), HasSubstr("--template"));
  EXPECT_THAT(refusal({"--emotion", "happy:4"}, 2), HasSubstr("1 to 3"));
  EXPECT_THAT(refusal({"--style", "W999"}, 2), HasSubstr("M003, W028"));
  EXPECT_THAT(refusal({"--draw", "17"}, 2), HasSubstr("16 codes"));
  EXPECT_THAT(refusal({"--flame", "absent.pkl"}, 3), HasSubstr("absent.pkl"));
  const auto other = animate({"--temperature", "1"});
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.err, HasSubstr("--temperature"));
  EXPECT_EQ(animate({"--flame", "x.pkl"}).exit_code, 2);
}

}  // namespace
}  // namespace mien
