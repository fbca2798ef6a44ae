#pragma once
#include <array>
#include <cstdint>
#include <vector>

namespace mien {

/// The five joints of FLAME, in its order.
enum class FlameJoint { global, neck, jaw, left_eye, right_eye };
inline constexpr std::size_t kNumFlameJoints = 5;
/// Numbers that a pose turns into before it corrects the shape: nine for every joint but the first.
inline constexpr std::size_t kNumFlamePoseFeatures = 9 * (kNumFlameJoints - 1);

/// A FLAME head model (Li et al. 2017, "Learning a model of facial shape and expression from 4D scans") as
/// its file holds it, in metres. The file has a licence of its own; users bring theirs. Read by io
/// (flame_file.h), posed by face (flame.h).
struct FlameModel {
  std::int64_t num_vertices = 0;               ///< V; 5023 in the published models
  std::int64_t num_shapes = 0;                 ///< S: 300 of shape, then those of expression
  std::vector<float> neutral;                  ///< [V, 3]
  std::vector<float> shapes;                   ///< [S, V, 3] offsets at parameter 1
  std::vector<float> pose_shapes;              ///< [36, V, 3] offsets at pose feature 1
  std::vector<float> joint_regressor;          ///< [5, V]: joints as sums of vertices
  std::vector<float> weights;                  ///< [V, 5]: share of every joint in a vertex
  std::array<int, kNumFlameJoints> parents{};  ///< -1 for the first; a parent stands before its children
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< [F]
};

}  // namespace mien
