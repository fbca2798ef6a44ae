#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <stdexcept>

#include "mien/core/arkit.h"
#include "mien/core/character.h"
#include "mien/core/motion.h"

namespace mien {
namespace {

TEST(Arkit, OrdersArePermutationsOfKnownNames) {
  const auto all = arkit_order(ArkitOrder::apple);
  EXPECT_EQ(std::set(all.begin(), all.end()).size(), 52u);
  for (const auto order : {ArkitOrder::live_link_csv, ArkitOrder::unreal, ArkitOrder::alphabetical}) {
    const auto names = arkit_order(order);
    EXPECT_EQ(std::set(names.begin(), names.end()), std::set(all.begin(), all.end()));
  }
  EXPECT_EQ(arkit_order(ArkitOrder::live_link_csv)[15], "jawRight");
  EXPECT_EQ(arkit_order(ArkitOrder::unreal)[15], "jawLeft");
  EXPECT_EQ(arkit_order(ArkitOrder::alphabetical)[0], "browDownLeft");
  const auto mediapipe = arkit_order(ArkitOrder::mediapipe);
  EXPECT_EQ(mediapipe.size(), 52u);
  EXPECT_EQ(mediapipe[0], "_neutral");
  EXPECT_EQ(mediapipe[51], "noseSneerRight");
  const auto said = arkit_order(ArkitOrder::said);
  EXPECT_EQ(said.size(), 32u);
  EXPECT_EQ(said.front(), "jawForward");
  EXPECT_EQ(said.back(), "noseSneerRight");
}

TEST(Arkit, MatchesTheSpellingsOfOtherPrograms) {
  for (const char* spelling : {"eyeBlinkLeft", "EyeBlinkLeft", "eyeBlink_L", "eyeBlink_l", "eyeBlinkL",
                               "EyeBlink_Left", "blendShapes.EyeBlinkLeft", "blendShape1.eyeBlinkLeft"})
    EXPECT_EQ(match_arkit_name(spelling), "eyeBlinkLeft") << spelling;
  EXPECT_EQ(match_arkit_name("browInnerUp_R"), "browInnerUp");
  EXPECT_EQ(match_arkit_name("JawLeft"), "jawLeft");
  for (const char* other : {"", "jawL", "viseme_aa", "eyeBlink", "_neutral", "jaw", "mouth_l"})
    EXPECT_FALSE(match_arkit_name(other)) << other;
}

TEST(Motion, CountsFramesAndResamples) {
  EXPECT_EQ(num_motion_frames(1.0, 60), 60);
  EXPECT_EQ(num_motion_frames(0.0, 60), 0);
  const Motion ramp{MotionSpace::arkit, {"jawOpen", "mouthClose"}, 30, {0, 1, 1, 0, 2, 1}};
  const Motion up = resample(ramp, 60);
  ASSERT_EQ(up.num_frames(), 6);
  EXPECT_FLOAT_EQ(up.frame(1)[0], 0.5f);
  EXPECT_FLOAT_EQ(up.frame(4)[0], 2.0f);
  EXPECT_FLOAT_EQ(up.frame(5)[1], 1.0f);
  EXPECT_EQ(resample(Motion{MotionSpace::arkit, {"jawOpen"}, 30, {}}, 60).num_frames(), 0);
  EXPECT_EQ(resample(Motion{MotionSpace::arkit, {"jawOpen"}, 60, {0.5f}}, 24).num_frames(), 1);
  for (const float v : resample(Motion{MotionSpace::arkit, {"jawOpen"}, 30, {3e38f, -3e38f}}, 90).values)
    EXPECT_TRUE(std::isfinite(v));
  EXPECT_EQ(ramp.find("mouthClose"), 1);
  EXPECT_FALSE(ramp.find("tongueOut"));
}

TEST(Blendshapes, AreLinearUnclampedAndChecked) {
  const std::vector<Vec3> neutral = {{0, 0, 0}, {1, 0, 0}};
  const std::vector<Blendshape> shapes = {{"a", {1}, {{0, 2, 0}}, {}}};
  std::vector<Vec3> out(2);
  evaluate_blendshapes(neutral, shapes, std::vector<float>{-0.5f}, out);
  EXPECT_EQ(out[0], (Vec3{0, 0, 0}));
  EXPECT_EQ(out[1], (Vec3{1, -1, 0}));
  EXPECT_THROW(evaluate_blendshapes(neutral, shapes, {}, out), std::logic_error);
  std::vector<Vec3> small(1);
  EXPECT_THROW(evaluate_blendshapes(neutral, shapes, std::vector<float>{0}, small), std::logic_error);
}

TEST(Mesh, NormalsFaceOutwardAndSurviveZeroArea) {
  const auto n = vertex_normals({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 5, 5}}, {{{0, 1, 2}}, {{3, 3, 3}}});
  EXPECT_EQ(n[0], (Vec3{0, 0, 1}));
  EXPECT_EQ(n[3], (Vec3{0, 0, 1}));
}

}  // namespace
}  // namespace mien
