#include "mien/face/pose.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

#include "built_head.h"
#include "mien/face/regions.h"

namespace mien {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

Character plain_character() {
  Character c;
  c.parts.resize(2);
  Mesh& skin = c.parts[0].mesh;
  skin.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  skin.triangles = {{0, 1, 2}};
  c.parts[0].shapes = {{"jawOpen", {1}, {{0, 0, 1}}, {}}};
  c.parts[1].mesh.positions = {{0, 0, 2}};
  c.parts[1].shapes = {{"Jaw_Open", {0}, {{0, -1, 0}}, {}}};
  return c;
}

void expect_near(Vec3 a, Vec3 b, float tolerance = 1e-6f) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

TEST(Pose, ChannelMovesEveryPartThatKnowsItsName) {
  const Character c = plain_character();
  const std::vector<std::string> channels = {"jawOpen", "smell"};
  const Poser poser(c, channels);
  EXPECT_THAT(poser.unused_channels(), ElementsAre("smell"));
  PosedCharacter out;
  poser.pose(std::array{0.5f, 9.0f}, out);
  expect_near(out[0].positions[1], {1, 0, 0.5f});
  expect_near(out[1].positions[0], {0, -0.5f, 2});
}

TEST(Pose, NormalsFollowTheSurface) {
  const Character c = plain_character();
  const std::vector<std::string> channels = {"jawOpen"};
  PosedCharacter out;
  Poser(c, channels).pose(std::array{1.0f}, out);
  const float h = std::sqrt(0.5f);
  for (const Vec3& n : out[0].normals) expect_near(n, {-h, 0, h});
  expect_near(out[1].normals[0], {0, 0, 1});  // no triangle: any unit normal
}

TEST(Pose, AnglesTurnAsTheirNamesSay) {
  const Vec3 front{0, 0, 1}, right_ear{-1, 0, 0};
  EXPECT_GT(head_rotation({20, 0, 0})(front).x, 0.3f);       // to the subject's left
  EXPECT_GT(head_rotation({0, 20, 0})(front).y, 0.3f);       // up
  EXPECT_LT(head_rotation({0, 0, 20})(right_ear).y, -0.3f);  // right ear down
  expect_near(head_rotation({90, 0, 0})(front), {1, 0, 0});
  // Roll first, then pitch, then yaw: the face of a rolled head still turns about the vertical axis.
  expect_near(head_rotation({90, 0, 35})(front), {1, 0, 0});
  expect_near(head_rotation({90, 30, 0})(front), {std::sqrt(3.0f) / 2, 0.5f, 0});
}

TEST(Pose, QuaternionAndMatrixAgree) {
  const HeadAngles angles{31, -17, 8};
  const auto [x, y, z, w] = head_quaternion(angles);
  EXPECT_NEAR(x * x + y * y + z * z + w * w, 1, 1e-6);
  for (const Vec3 v : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0.2f, -0.3f, 0.9f}}) {
    const Vec3 u{x, y, z};
    const Vec3 t = 2 * cross(u, v);
    expect_near(head_rotation(angles)(v), v + w * t + cross(u, t));
  }
}

TEST(Pose, HeadTurnsAboutThePivot) {
  const Character c = plain_character();
  const std::vector<std::string> channels = {"headYaw", "headPitch", "headRoll"};
  PosedCharacter out;
  Poser(c, channels, Vec3{1, 0, 0}).pose(std::array{90.0f, 0.0f, 0.0f}, out);
  expect_near(out[0].positions[1], {1, 0, 0});
  expect_near(out[0].positions[0], {1, 0, 1});
  expect_near(out[0].normals[0], {1, 0, 0});
}

TEST(Pose, RestPoseIsTheCharacter) {
  const Character& head = test::built_head().character;
  const auto rest = rest_pose(head);
  ASSERT_EQ(rest.size(), head.parts.size());
  for (std::size_t p = 0; p < rest.size(); ++p) {
    EXPECT_EQ(rest[p].positions, head.parts[p].mesh.positions);
    for (const Vec3& n : rest[p].normals) ASSERT_NEAR(length(n), 1, 1e-5);
  }
}

TEST(Pose, DefaultHeadUsesEveryChannel) {
  const auto channels = arkit_and_head_channels();
  EXPECT_THAT(Poser(test::built_head().character, channels).unused_channels(), IsEmpty());
}

TEST(Pose, JawOpenPartsTheLipsAndMouthCloseSealsThem) {
  const Character& head = test::built_head().character;
  const std::vector<std::string> channels = {"jawOpen", "mouthClose"};
  const Poser poser(head, channels);
  PosedCharacter out;
  const auto gap = [&](float open, float close) {
    poser.pose(std::array{open, close}, out);
    return lip_gap(head, out[0].positions).value();
  };
  EXPECT_EQ(gap(0, 0), 0.0f);
  EXPECT_NEAR(gap(1, 0), 0.0333f, 1e-4);
  EXPECT_NEAR(gap(0.5f, 0), 0.5f * gap(1, 0), 1e-7);
  EXPECT_LT(gap(0.7f, 0.7f), 1e-8f);  // single precision
}

TEST(Pose, ValuesThatAreNotFiniteCountAsZero) {
  const Character c = plain_character();
  const std::vector<std::string> channels = {"jawOpen", "headYaw"};
  PosedCharacter out;
  Poser(c, channels)
      .pose(std::array{std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}, out);
  EXPECT_EQ(out[0].positions, c.parts[0].mesh.positions);
}

TEST(Pose, EmptyCharacterAndWrongFrame) {
  const Character none;
  expect_near(neck_pivot(none), {});
  PosedCharacter out(3);
  Poser(none, {}).pose({}, out);
  EXPECT_THAT(out, IsEmpty());
  EXPECT_THROW(Poser(none, {}).pose(std::array{1.0f}, out), std::logic_error);
}

TEST(Pose, PivotOfTheDefaultHeadLiesInTheNeck) {
  const Vec3 pivot = neck_pivot(test::built_head().character);
  EXPECT_NEAR(pivot.x, 0, 1e-4);
  EXPECT_NEAR(pivot.y, -0.065, 0.002);
  EXPECT_NEAR(pivot.z, -0.008, 0.002);
}

}  // namespace
}  // namespace mien
