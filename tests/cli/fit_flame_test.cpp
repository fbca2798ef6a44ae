// mien fit --flame: coefficients of a rig to FLAME's expression and jaw, and back.
#include <gmock/gmock.h>

#include <cmath>

#include "made_flame.h"
#include "mien/base/file.h"
#include "mien/io/character_file.h"
#include "mien/io/gltf_writer.h"
#include "mien/io/mesh_file.h"
#include "mien/io/motion_file.h"
#include "mien/io/npy.h"
#include "program.h"
#include "sheet_face.h"

namespace mien {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class FitFlameTest : public ProgramTest {
 protected:
  FitFlameTest() {
    const Character rig = sheet_face(11, 11);
    const auto glb = write_glb(rig, {});
    EXPECT_TRUE(write_file(in_folder("rig.glb"), std::span<const std::byte>(glb.value())));
    write("made.pkl", flame_pickle(made_flame(rig.parts.front().mesh, rig.parts.front().shapes)));
    Motion motion{MotionSpace::arkit, {"jawOpen", "mouthSmileLeft", "browInnerUp", "headYaw"}, 60, {}};
    for (int n = 0; n < 60; ++n)
      for (int c = 0; c < 4; ++c)
        motion.values.push_back(static_cast<float>(0.3 - 0.3 * std::cos(0.11 * n + 0.8 * c)));
    EXPECT_TRUE(write_motion(in_folder("curves.json"), motion));
  }
  [[nodiscard]] Outcome fit(std::vector<std::string> more) const {
    more.insert(more.begin(), "fit");
    more.insert(more.end(), {"--flame", "made.pkl", "--character", "rig.glb"});
    return mien(more);
  }
  static double left_mm(const Outcome& run) {
    return nlohmann::json::parse(run.out).at("residual").at("all").at("max_mm").get<double>();
  }
};

TEST_F(FitFlameTest, CurvesGoToFlameAndComeBack) {
  const auto there = fit({"curves.json", "-o", "flame.npy", "--expressions", "2", "--json"});
  ASSERT_EQ(there.exit_code, 0) << there.err;
  EXPECT_LT(left_mm(there), 1.0) << "the jaw turns, the shape is straight: 30 mm at most";
  const auto parameters = read_motion(in_folder("flame.npy"));
  ASSERT_TRUE(parameters) << parameters.error().message();
  EXPECT_EQ(parameters->space, MotionSpace::flame);
  EXPECT_EQ(parameters->num_frames(), 25) << "at FLAME's 25 frames a second";
  const auto layout = read_npy_layout(bytes_of("flame.npy"));
  EXPECT_THAT(layout->shape, ElementsAre(1, 25, 403));

  const auto back = fit({"flame.npy", "-o", "back.json", "--json", "--residuals", "left.csv"});
  ASSERT_EQ(back.exit_code, 0) << back.err;
  EXPECT_LT(left_mm(back), 1.0);
  const auto curves = read_motion(in_folder("back.json")), truth = read_motion(in_folder("curves.json"));
  ASSERT_TRUE(curves && truth);
  EXPECT_THAT(curves->channels, ElementsAre("jawOpen", "mouthSmileLeft", "browInnerUp"));
  ASSERT_EQ(curves->num_frames(), 60);
  for (std::int64_t n = 0; n < 57; ++n)  // the last instant of 25 frames is 0.96 s
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(curves->frame(n)[c], truth->frame(n)[c], 0.04) << n;
  EXPECT_THAT(as_text(bytes_of("left.csv")), HasSubstr("sequence,frame,all_mm\nflame,0,"));
}

// The rig may be another face than FLAME's: movements go from one to the other.
TEST_F(FitFlameTest, VerticesAndOtherFacesOfTheTopologyAreTaken) {
  ASSERT_EQ(mien({"render", "curves.json", "--character", "rig.glb", "-o", "moved.npy"}).exit_code, 0);
  ASSERT_EQ(fit({"moved.npy", "--fps", "60", "-o", "a.csv"}).exit_code, 0);
  ASSERT_EQ(fit({"curves.json", "-o", "b.csv"}).exit_code, 0);
  const auto a = read_motion(in_folder("a.csv"));
  ASSERT_TRUE(a) << a.error().message();
  ASSERT_EQ(a->num_frames(), 25);

  Character other = sheet_face(11, 11);
  for (Vec3& p : other.parts.front().mesh.positions) p.z += 0.3f * p.x * p.x + 0.01f;
  const auto glb = write_glb(other, {});
  ASSERT_TRUE(write_file(in_folder("other.glb"), std::span<const std::byte>(*glb)));
  ASSERT_EQ(
      mien({"fit", "b.csv", "--flame", "made.pkl", "--character", "other.glb", "-o", "other.json"}).exit_code,
      0);
  ASSERT_EQ(fit({"b.csv", "-o", "own.json"}).exit_code, 0);
  const auto theirs = read_motion(in_folder("other.json")), own = read_motion(in_folder("own.json"));
  ASSERT_TRUE(theirs && own);
  for (std::size_t i = 0; i < own->values.size(); ++i) EXPECT_NEAR(theirs->values[i], own->values[i], 1e-4);
}

TEST_F(FitFlameTest, TheShapeOfAPersonIsLeftOut) {
  Motion motion{MotionSpace::flame, {"shape_0", "expression_0", "jaw_x"}, 25, {3, 1, 0.1f, 3, 1, 0.1f}};
  ASSERT_TRUE(write_motion(in_folder("big.json"), motion));
  for (std::size_t n = 0; n < 2; ++n) motion.values[3 * n] = 0;
  ASSERT_TRUE(write_motion(in_folder("plain.json"), motion));
  ASSERT_EQ(fit({"big.json", "-o", "a.json"}).exit_code, 0);
  ASSERT_EQ(fit({"plain.json", "-o", "b.json"}).exit_code, 0);
  EXPECT_EQ(read_motion(in_folder("a.json"))->values, read_motion(in_folder("b.json"))->values);
}

TEST_F(FitFlameTest, TransferMakesTheRigFromTheModelFile) {
  std::filesystem::create_directories(in_folder("shapes"));
  write("shapes/neutral.obj", write_obj(sheet_mesh(9, 9)));
  write("shapes/jawOpen.obj", write_obj(sheet_mesh(9, 9, 0.3)));
  write("pairs.csv", "source,target\n0,0\n8,10\n72,110\n80,120\n40,60\n");
  const auto made =
      mien({"transfer", "made.pkl", "--from", "shapes", "--markers", "pairs.csv", "-o", "own.glb"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const auto rig = load_character(in_folder("own.glb"));
  ASSERT_TRUE(rig) << rig.error().message();
  EXPECT_EQ(rig->parts.front().mesh.positions.size(), 121u);
  const auto run =
      mien({"fit", "curves.json", "--flame", "made.pkl", "--character", "own.glb", "-o", "a.npy"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
}

TEST_F(FitFlameTest, RefusesWhatDoesNotFit) {
  const auto refusal = [&](const Outcome& run, int code) {
    EXPECT_EQ(run.exit_code, code) << run.err;
    return run.err;
  };
  EXPECT_THAT(refusal(fit({"curves.json", "-o", "a.glb"}), 2), HasSubstr("cannot hold FLAME parameters"));
  EXPECT_THAT(refusal(fit({"curves.json", "-o", "a.npy", "--expressions", "3"}), 4),
              HasSubstr("2 expressions"));
  EXPECT_THAT(refusal(mien({"fit", "curves.json", "--flame", "made.pkl", "-o", "a.npy"}), 4),
              HasSubstr("mien transfer"));
  EXPECT_THAT(refusal(mien({"fit", "curves.json", "--expressions", "3", "-o", "a.npy"}), 2),
              HasSubstr("--flame"));
  EXPECT_THAT(
      refusal(mien({"fit", "curves.json", "--flame", "no.pkl", "--character", "rig.glb", "-o", "a.npy"}), 3),
      HasSubstr("no.pkl"));
  write("empty.csv", "time,jaw_x\n");
  EXPECT_EQ(fit({"empty.csv", "-o", "a.csv"}).exit_code, 0) << "no frames are no frames";
  EXPECT_THAT(std::string(as_text(bytes_of("a.csv"))), testing::StartsWith("Timecode,"));
}

}  // namespace
}  // namespace mien
