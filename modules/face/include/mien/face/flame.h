#pragma once
#include <array>
#include <span>
#include <vector>

#include "mien/base/result.h"
#include "mien/core/flame_model.h"
#include "mien/core/mesh.h"
#include "mien/core/motion.h"

namespace mien {

/// Parameters of one face. Missing ones are 0.
struct FlamePose {
  std::span<const float> shape;       ///< at most 300
  std::span<const float> expression;  ///< at most as many as the model has
  /// Rotation of each joint against its parent: an axis times an angle in radians, by FlameJoint.
  std::array<std::array<float, 3>, kNumFlameJoints> rotations{};
};

/// Poses a FLAME model (Li et al. 2017, section 4): shape and expression move vertices and joints, the pose
/// corrects them, and the joints' rotations are blended by weights. Computed in double on the file's numbers
/// as float32.
class FlamePoser {
 public:
  /// @param model  must outlive the poser @pre of a reader: sizes fit
  explicit FlamePoser(const FlameModel& model);

  /// @param out  [3 V] positions in metres @pre sizes fit. Safe from many threads
  void pose(const FlamePose& face, std::span<float> out) const;
  [[nodiscard]] const FlameModel& model() const { return *model_; }

 private:
  using Point = std::array<double, 3>;
  const FlameModel* model_;
  // Joints are linear in the shape, so the mesh is not needed to place them.
  std::array<Point, kNumFlameJoints> neutral_joints_{};
  std::vector<std::array<Point, kNumFlameJoints>> joint_shapes_;  ///< [S]
};

/// Vertices of a motion in the space `flame` as a motion of vertices, in metres. Global, neck and eye
/// rotations are 0. Errors (Errc::incompatible): the motion moves an expression that the model does not have;
/// (Errc::input): a parameter that is not finite. Bits do not depend on threads.
Result<Motion> flame_vertices(const FlamePoser& poser, const Motion& parameters, int num_threads = 1);

/// The face of the model at rest, with its triangles.
Mesh flame_mesh(const FlameModel& model);

}  // namespace mien
