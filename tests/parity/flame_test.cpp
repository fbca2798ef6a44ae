// FLAME: the recorded model from its pickle, and the recorded poses.
#include "mien/face/flame.h"

#include <gtest/gtest.h>

#include "closeness.h"
#include "fixture.h"
#include "mien/core/flame_parameters.h"
#include "mien/face/carried_movement.h"
#include "mien/io/flame_file.h"

namespace mien::parity {
namespace {

void for_each_flame(void (*body)(const FlameModel&, const Fixture&)) {
  for_each_case("probtalk3d", "flame_", ".pkl", [&](const std::string& name) {
    const auto model = read_flame_model(fixture_root() / "probtalk3d" / ("flame_" + name + ".pkl"));
    ASSERT_TRUE(model) << model.error().message();
    body(*model, Fixture("probtalk3d", "flame_" + name + ".safetensors"));
  });
}

std::array<float, 3> three(std::span<const float> row, std::size_t first) {
  return {row[first], row[first + 1], row[first + 2]};
}

TEST(Flame, ThePickleHoldsTheRecordedArrays) {
  for_each_flame([](const FlameModel& model, const Fixture& recorded) {
    const auto expect = [&](const std::vector<float>& got, const std::string& name) {
      EXPECT_EQ(got, recorded.file().read_float(name).value()) << name;
    };
    expect(model.neutral, "model.v_template");
    expect(model.weights, "model.weights");
    expect(model.joint_regressor, "model.J_regressor");
    // Directions lie one after the other here, side by side in the file.
    const auto shapes = recorded.file().read_float("model.shapedirs").value();
    const auto v3 = static_cast<std::size_t>(3 * model.num_vertices),
               count = static_cast<std::size_t>(model.num_shapes);
    ASSERT_EQ(shapes.size(), model.shapes.size());
    for (std::size_t i = 0; i < v3; ++i)
      for (std::size_t s = 0; s < count; ++s) ASSERT_EQ(model.shapes[s * v3 + i], shapes[i * count + s]);
    const auto faces = recorded.integers("model.faces");
    ASSERT_EQ(3 * model.triangles.size(), faces.size());
    for (std::size_t i = 0; i < faces.size(); ++i) ASSERT_EQ(model.triangles[i / 3][i % 3], faces[i]);
    EXPECT_EQ(model.parents, (std::array<int, 5>{-1, 0, 1, 1, 1}));
  });
}

TEST(Flame, PosesAsRecorded) {
  for_each_flame([](const FlameModel& model, const Fixture& recorded) {
    const FlamePoser poser(model);
    const Tensor shape = recorded.tensor("in.shape"), expression = recorded.tensor("in.expression"),
                 jaw = recorded.tensor("in.pose_global_jaw"), neck = recorded.tensor("in.neck_pose"),
                 eyes = recorded.tensor("in.eye_pose"), whole = recorded.tensor("out.full.vertices"),
                 face = recorded.tensor("out.probtalk.vertices"),
                 still = recorded.tensor("out.zero_pose.vertices");
    const std::int64_t num_poses = shape.num_rows(), width = 3 * model.num_vertices;
    Tensor full = Tensor::uninitialized({num_poses, width});
    Motion motion{MotionSpace::flame, flame_channels(0, 50), 25, {}};
    for (std::int64_t n = 0; n < num_poses; ++n) {
      FlamePose pose;
      pose.shape = shape.row(n);
      pose.expression = expression.row(n);
      pose.rotations = {three(jaw.row(n), 0), three(neck.row(n), 0), three(jaw.row(n), 3),
                        three(eyes.row(n), 0), three(eyes.row(n), 3)};
      poser.pose(pose, full.row(n));
      const auto first = expression.row(n).first(50);
      motion.values.insert(motion.values.end(), first.begin(), first.end());
      const auto turn = jaw.row(n).subspan(3, 3);
      motion.values.insert(motion.values.end(), turn.begin(), turn.end());
    }
    MIEN_EXPECT_CLOSE(full, whole.reshaped({num_poses, width}), "flame");
    const auto vertices = flame_vertices(poser, motion, 2);
    ASSERT_TRUE(vertices) << vertices.error().message();
    MIEN_EXPECT_CLOSE(Tensor({num_poses, width}, vertices->values), face.reshaped({num_poses, width}),
                      "flame");
    EXPECT_EQ(vertices->values, flame_vertices(poser, motion, 1)->values);
    Tensor rest = Tensor::uninitialized({1, width});
    poser.pose({}, rest.values());
    MIEN_EXPECT_CLOSE(rest, still.reshaped({1, width}), "flame");
  });
}

// A face that was written with z up, and movement of the model on it.
TEST(Flame, MovementIsCarriedAsRecorded) {
  for_each_case("probtalk3d", "", "_transfer.safetensors", [](const std::string& name) {
    const Fixture recorded("probtalk3d", name + "_transfer.safetensors");
    const auto positions = recorded.doubles("in.new_face");
    Mesh face;
    for (std::size_t i = 0; i + 2 < positions.size(); i += 3)
      face.positions.push_back({static_cast<float>(positions[i]), static_cast<float>(positions[i + 1]),
                                static_cast<float>(positions[i + 2])});
    turn_z_up(face);
    const auto rotated = recorded.doubles("mid.rotated");
    for (std::size_t v = 0; v < face.positions.size(); ++v) {
      EXPECT_EQ(face.positions[v].x, static_cast<float>(rotated[3 * v]));
      EXPECT_EQ(face.positions[v].y, static_cast<float>(rotated[3 * v + 1]));
      EXPECT_EQ(face.positions[v].z, static_cast<float>(rotated[3 * v + 2]));
    }
    const auto frames = recorded.file().as<float>("in.vertices").value();
    const Motion motion = vertex_motion({"recorded", static_cast<std::int64_t>(face.positions.size())}, 25,
                                        {frames.begin(), frames.end()});
    const auto carried = carry_movement(motion, recorded.tensor("in.zero_pose").values(), face);
    ASSERT_TRUE(carried) << carried.error().message();
    const auto want = recorded.doubles("out.transferred");
    ASSERT_EQ(carried->values.size(), want.size());
    MIEN_EXPECT_CLOSE(std::vector<double>(carried->values.begin(), carried->values.end()), want, "flame");
  });
}

}  // namespace
}  // namespace mien::parity
