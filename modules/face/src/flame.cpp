#include "mien/face/flame.h"

#include <cmath>

#include "mien/base/contract.h"
#include "mien/base/parallel.h"
#include "mien/core/flame_parameters.h"

namespace mien {
namespace {

using Point = std::array<double, 3>;
using Matrix = std::array<double, 9>;  // 3 x 3, row by row

// The original adds this to every component before it takes the length, so that no rotation is no division by
// 0.
constexpr double kTiny = 1e-8;

Matrix rotation_of(const std::array<float, 3>& r) {
  double squares = 0;
  for (const float v : r) squares += (static_cast<double>(v) + kTiny) * (static_cast<double>(v) + kTiny);
  const double angle = std::sqrt(squares), s = std::sin(angle), c = 1 - std::cos(angle);
  const double x = r[0] / angle, y = r[1] / angle, z = r[2] / angle;
  const Matrix k = {0, -z, y, z, 0, -x, -y, x, 0};
  Matrix rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) {
      double square = 0;
      for (std::size_t n = 0; n < 3; ++n) square += k[3 * i + n] * k[3 * n + j];
      rotation[3 * i + j] += s * k[3 * i + j] + c * square;
    }
  return rotation;
}

Matrix product(const Matrix& a, const Matrix& b) {
  Matrix out{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      for (std::size_t n = 0; n < 3; ++n) out[3 * i + j] += a[3 * i + n] * b[3 * n + j];
  return out;
}

Point transformed(const Matrix& m, const Point& p) {
  Point out{};
  for (std::size_t i = 0; i < 3; ++i) out[i] = m[3 * i] * p[0] + m[3 * i + 1] * p[1] + m[3 * i + 2] * p[2];
  return out;
}

Point sum(const Point& a, const Point& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
Point difference(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

// y += factor x
void add_scaled(std::span<double> y, double factor, std::span<const float> x) {
  for (std::size_t i = 0; i < y.size(); ++i) y[i] += factor * static_cast<double>(x[i]);
}

}  // namespace

FlamePoser::FlamePoser(const FlameModel& model) : model_(&model) {
  const auto v3 = static_cast<std::size_t>(3 * model.num_vertices);
  contract(model.neutral.size() == v3 &&
               model.shapes.size() == v3 * static_cast<std::size_t>(model.num_shapes) &&
               model.pose_shapes.size() == v3 * kNumFlamePoseFeatures &&
               3 * model.joint_regressor.size() == 5 * v3 && 3 * model.weights.size() == 5 * v3,
           "FlamePoser: the sizes of the model do not fit each other");
  const auto joints_of = [&](std::span<const float> positions) {
    std::array<Point, kNumFlameJoints> joints{};
    for (std::size_t j = 0; j < kNumFlameJoints; ++j)
      for (std::size_t v = 0; 3 * v < v3; ++v)
        for (std::size_t k = 0; k < 3; ++k)
          joints[j][k] += static_cast<double>(model.joint_regressor[j * v3 / 3 + v]) *
                          static_cast<double>(positions[3 * v + k]);
    return joints;
  };
  neutral_joints_ = joints_of(model.neutral);
  for (std::size_t s = 0; s < static_cast<std::size_t>(model.num_shapes); ++s)
    joint_shapes_.push_back(joints_of(std::span(model.shapes).subspan(s * v3, v3)));
}

void FlamePoser::pose(const FlamePose& face, std::span<float> out) const {
  const FlameModel& m = *model_;
  const auto v3 = static_cast<std::size_t>(3 * m.num_vertices);
  const auto num_expression = static_cast<std::size_t>(m.num_shapes) - kNumFlameShape;
  contract(
      out.size() == v3 && face.shape.size() <= kNumFlameShape && face.expression.size() <= num_expression,
      "FlamePoser::pose: parameters or positions do not fit the model");
  std::vector<double> positions(m.neutral.begin(), m.neutral.end());
  auto joints = neutral_joints_;
  const auto move = [&](std::size_t direction, float parameter) {
    if (parameter == 0) return;
    add_scaled(positions, parameter, std::span(m.shapes).subspan(direction * v3, v3));
    for (std::size_t j = 0; j < kNumFlameJoints; ++j)
      for (std::size_t k = 0; k < 3; ++k) joints[j][k] += parameter * joint_shapes_[direction][j][k];
  };
  for (std::size_t i = 0; i < face.shape.size(); ++i) move(i, face.shape[i]);
  for (std::size_t i = 0; i < face.expression.size(); ++i) move(kNumFlameShape + i, face.expression[i]);

  std::array<Matrix, kNumFlameJoints> rotations;
  for (std::size_t j = 0; j < kNumFlameJoints; ++j) rotations[j] = rotation_of(face.rotations[j]);
  for (std::size_t j = 1; j < kNumFlameJoints; ++j)
    for (std::size_t i = 0; i < 9; ++i) {
      const double feature = rotations[j][i] - (i % 4 == 0 ? 1 : 0);
      if (feature != 0)
        add_scaled(positions, feature, std::span(m.pose_shapes).subspan((9 * (j - 1) + i) * v3, v3));
    }

  // Along the tree: rotation and place of every joint, then what it does to a point at rest.
  std::array<Matrix, kNumFlameJoints> turned;
  std::array<Point, kNumFlameJoints> placed, offsets;
  turned[0] = rotations[0], placed[0] = joints[0];
  for (std::size_t j = 1; j < kNumFlameJoints; ++j) {
    const auto parent = static_cast<std::size_t>(m.parents[j]);
    turned[j] = product(turned[parent], rotations[j]);
    placed[j] = sum(placed[parent], transformed(turned[parent], difference(joints[j], joints[parent])));
  }
  for (std::size_t j = 0; j < kNumFlameJoints; ++j)
    offsets[j] = difference(placed[j], transformed(turned[j], joints[j]));
  for (std::size_t v = 0; 3 * v < v3; ++v) {
    Matrix blended{};
    Point moved{};
    for (std::size_t j = 0; j < kNumFlameJoints; ++j) {
      const double share = m.weights[v * kNumFlameJoints + j];
      if (share == 0) continue;
      for (std::size_t i = 0; i < 9; ++i) blended[i] += share * turned[j][i];
      for (std::size_t k = 0; k < 3; ++k) moved[k] += share * offsets[j][k];
    }
    const Point p =
        sum(transformed(blended, {positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]}), moved);
    for (std::size_t k = 0; k < 3; ++k) out[3 * v + k] = static_cast<float>(p[k]);
  }
}

Result<Motion> flame_vertices(const FlamePoser& poser, const Motion& parameters, int num_threads) {
  const FlameModel& model = poser.model();
  const auto columns = flame_columns(parameters);
  const auto num_betas = static_cast<std::size_t>(model.num_shapes);
  constexpr std::size_t kNumBetas = kNumFlameShape + kNumFlameExpression;
  for (std::size_t i = 0; i < parameters.values.size(); ++i) {
    const auto& column = columns[i % columns.size()];
    if (!std::isfinite(parameters.values[i]))
      return Error{Errc::input, "FLAME parameters",
                   "frame " + std::to_string(i / columns.size()) + " is not finite", ""};
    // Files hold columns for all parameters; those that stay 0 need nothing of the model.
    if (column && *column < kNumBetas && *column >= num_betas && parameters.values[i] != 0)
      return Error{Errc::incompatible, "FLAME model",
                   "has " + std::to_string(num_betas - kNumFlameShape) + " expressions, the motion moves '" +
                       parameters.channels[i % columns.size()] + "'",
                   ""};
  }
  Motion motion = vertex_motion(topology_of(model.num_vertices), parameters.fps);
  const auto width = static_cast<std::size_t>(motion.num_channels());
  motion.values.resize(static_cast<std::size_t>(parameters.num_frames()) * width);
  parallel_for(num_threads, parameters.num_frames(), [&](std::int64_t n) {
    std::array<float, kNumFlame> all{};
    const auto frame = parameters.frame(n);
    for (std::size_t c = 0; c < columns.size(); ++c)
      if (columns[c]) all[*columns[c]] = frame[c];
    FlamePose pose;
    pose.shape = std::span(all).first(kNumFlameShape);
    pose.expression = std::span(all).subspan(kNumFlameShape, std::min(num_betas, kNumBetas) - kNumFlameShape);
    std::copy_n(all.end() - kNumFlameJaw, kNumFlameJaw,
                pose.rotations[static_cast<std::size_t>(FlameJoint::jaw)].begin());
    poser.pose(pose, std::span(motion.values).subspan(static_cast<std::size_t>(n) * width, width));
  });
  return motion;
}

Mesh flame_mesh(const FlameModel& model) {
  Mesh mesh;
  for (std::size_t v = 0; 3 * v + 2 < model.neutral.size(); ++v)
    mesh.positions.push_back({model.neutral[3 * v], model.neutral[3 * v + 1], model.neutral[3 * v + 2]});
  mesh.triangles = model.triangles;
  return mesh;
}

}  // namespace mien
