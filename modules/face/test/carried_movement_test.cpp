#include "mien/face/carried_movement.h"

#include <gtest/gtest.h>

namespace mien {
namespace {

Mesh points(std::vector<Vec3> positions) { return {std::move(positions), {}, {}, {}}; }

TEST(CarriedMovement, MovesTheOtherFaceByTheSameOffsets) {
  const std::vector<float> neutral = {0, 0, 0, 1, 1, 1};
  const Mesh face = points({{10, 20, 30}, {-1, -2, -3}});
  std::vector<float> frames = neutral;
  frames.insert(frames.end(), {0.5f, 0, 0, 1, 1, 3});
  const auto carried = carry_movement(vertex_motion({"two", 2}, 25, frames), neutral, face);
  ASSERT_TRUE(carried) << carried.error().message();
  EXPECT_EQ(carried->values, (std::vector<float>{10, 20, 30, -1, -2, -3, 10.5f, 20, 30, -1, -2, -1}));
  EXPECT_EQ(carried->fps, 25);
  EXPECT_EQ(carry_movement(vertex_motion({"two", 2}, 25), neutral, face)->num_frames(), 0);
}

TEST(CarriedMovement, RefusesAnotherTopology) {
  const std::vector<float> neutral(6);
  const Motion motion = vertex_motion({"two", 2}, 25, neutral);
  EXPECT_EQ(carry_movement(motion, neutral, points({{0, 0, 0}})).error().code, Errc::incompatible);
  EXPECT_EQ(carry_movement(motion, std::vector<float>(3), points({{}, {}})).error().code, Errc::incompatible);
  Motion rig = motion;
  rig.space = MotionSpace::rig;
  EXPECT_EQ(carry_movement(rig, neutral, points({{}, {}})).error().code, Errc::incompatible);
}

TEST(CarriedMovement, TurnsAMeshThatHasZUp) {
  Mesh mesh = points({{1, 2, 3}});
  mesh.normals = {{0, 0, 1}};
  turn_z_up(mesh);
  EXPECT_EQ(mesh.positions.front(), (Vec3{1, 3, -2}));
  EXPECT_EQ(mesh.normals.front(), (Vec3{0, 1, 0})) << "what looked up still does";
}

}  // namespace
}  // namespace mien
