#include "flame_equations.h"

#include <Eigen/Geometry>

#include "mien/base/contract.h"
#include "mien/core/flame_parameters.h"

namespace mien::face_detail {
namespace {

constexpr auto kJaw = static_cast<std::size_t>(FlameJoint::jaw);

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d matrix;
  matrix << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return matrix;
}

// The jaw's own weight and that of all joints that hang on it.
double share_of_jaw(const FlameModel& model, std::size_t vertex) {
  double share = 0;
  for (std::size_t joint = 0; joint < kNumFlameJoints; ++joint) {
    std::size_t above = joint;
    while (above != kJaw && model.parents[above] >= 0) above = static_cast<std::size_t>(model.parents[above]);
    if (above == kJaw) share += static_cast<double>(model.weights[vertex * kNumFlameJoints + joint]);
  }
  return share;
}

Eigen::RowVector3d jaw_joint_of(const FlameModel& model, const float* positions) {
  Eigen::RowVector3d joint = Eigen::RowVector3d::Zero();
  const auto count = static_cast<std::size_t>(model.num_vertices);
  for (std::size_t v = 0; v < count; ++v) {
    const double factor = model.joint_regressor[kJaw * count + v];
    if (factor == 0) continue;
    for (int k = 0; k < 3; ++k)
      joint[k] += factor * static_cast<double>(positions[3 * v + static_cast<std::size_t>(k)]);
  }
  return joint;
}

}  // namespace

FlameEquations::FlameEquations(const FlameModel& model, const std::vector<std::uint32_t>& vertices,
                               std::int64_t num_expressions) {
  const auto v3 = static_cast<std::size_t>(3 * model.num_vertices);
  const auto count = static_cast<Eigen::Index>(vertices.size());
  contract(
      num_expressions >= 0 && static_cast<std::int64_t>(kNumFlameShape) + num_expressions <= model.num_shapes,
      "FlameEquations: the model does not have so many expressions");
  contract(model.neutral.size() == v3 &&
               model.shapes.size() == v3 * static_cast<std::size_t>(model.num_shapes) &&
               model.pose_shapes.size() == v3 * kNumFlamePoseFeatures &&
               3 * model.joint_regressor.size() == kNumFlameJoints * v3 &&
               3 * model.weights.size() == kNumFlameJoints * v3,
           "FlameEquations: the sizes of the model do not fit each other");
  const auto point = [&](const float* of, std::uint32_t v, int k) {
    return static_cast<double>(of[3 * static_cast<std::size_t>(v) + static_cast<std::size_t>(k)]);
  };
  neutral_.resize(count, 3);
  share_.resize(count);
  for (auto& c : corrections_) c.resize(count, 3);
  for (Eigen::Index i = 0; i < count; ++i) {
    const std::uint32_t v = vertices[static_cast<std::size_t>(i)];
    contract(3 * static_cast<std::size_t>(v) < v3, "FlameEquations: a vertex that the model does not have");
    share_[i] = share_of_jaw(model, v);
    for (int k = 0; k < 3; ++k) {
      neutral_(i, k) = point(model.neutral.data(), v, k);
      for (std::size_t f = 0; f < 9; ++f)
        corrections_[f](i, k) = point(model.pose_shapes.data() + (9 * (kJaw - 1) + f) * v3, v, k);
    }
  }
  joint_ = jaw_joint_of(model, model.neutral.data());
  joint_directions_.resize(num_expressions, 3);
  for (auto& d : directions_) d.resize(count, num_expressions);
  for (auto& t : turned_) t.resize(count, num_expressions);
  for (Eigen::Index e = 0; e < num_expressions; ++e) {
    const float* direction = model.shapes.data() + (kNumFlameShape + static_cast<std::size_t>(e)) * v3;
    joint_directions_.row(e) = jaw_joint_of(model, direction);
    for (int k = 0; k < 3; ++k) {
      const auto a = static_cast<std::size_t>(k);
      for (Eigen::Index i = 0; i < count; ++i)
        directions_[a](i, e) = point(direction, vertices[static_cast<std::size_t>(i)], k);
      turned_[a].col(e) = share_.array() * (directions_[a].col(e).array() - joint_directions_(e, k));
    }
  }
  straight_ = Eigen::MatrixXd::Zero(num_expressions, num_expressions);
  for (std::size_t a = 0; a < 3; ++a) {
    straight_ += directions_[a].transpose() * directions_[a];
    for (std::size_t b = 0; b < 3; ++b) {
      mixed_[a][b] = directions_[a].transpose() * turned_[b];
      squared_[a][b] = turned_[a].transpose() * turned_[b];
    }
  }
}

void FlameEquations::pose(State& state) const {
  const Eigen::Matrix3d a = state.rotation - Eigen::Matrix3d::Identity();
  Points straight = neutral_;
  for (int k = 0; k < 3; ++k) straight.col(k) += directions_[static_cast<std::size_t>(k)] * state.expression;
  for (int f = 0; f < 9; ++f)
    if (const double feature = a(f / 3, f % 3); feature != 0)
      straight += feature * corrections_[static_cast<std::size_t>(f)];
  const Eigen::RowVector3d joint = joint_ + state.expression.transpose() * joint_directions_;
  state.around_jaw = share_.asDiagonal() * (straight.rowwise() - joint);
  state.vertices = straight + state.around_jaw * a.transpose();
}

void FlameEquations::linearise(const State& state, const Points& residual, Eigen::MatrixXd& matrix,
                               Eigen::VectorXd& right) const {
  const Eigen::Index count = num_expressions();
  const Eigen::Matrix3d a = state.rotation - Eigen::Matrix3d::Identity(), aa = a.transpose() * a;
  // What the vertices and the residual are against: 0 the residual, 1 to 3 the jaw's columns.
  std::array<Points, 4> against;
  against[0] = residual;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Matrix3d turn = cross_matrix(Eigen::Vector3d::Unit(i)) * state.rotation;
    Points correction = Points::Zero(num_vertices(), 3);
    for (int f = 0; f < 9; ++f) correction += turn(f / 3, f % 3) * corrections_[static_cast<std::size_t>(f)];
    against[static_cast<std::size_t>(i) + 1] =
        correction + share_.asDiagonal() * (correction * a.transpose()) + state.around_jaw * turn.transpose();
  }
  Eigen::MatrixXd products = Eigen::MatrixXd::Zero(count, 4);
  Eigen::MatrixXd straight(num_vertices(), 4), turned(num_vertices(), 4);
  for (int k = 0; k < 3; ++k) {
    for (int i = 0; i < 4; ++i) {
      const Points& y = against[static_cast<std::size_t>(i)];
      straight.col(i) = y.col(k);
      turned.col(i) = y * a.col(k);
    }
    products += directions_[static_cast<std::size_t>(k)].transpose() * straight;
    products += turned_[static_cast<std::size_t>(k)].transpose() * turned;
  }
  matrix.resize(count + 3, count + 3);
  auto expressions = matrix.topLeftCorner(count, count);
  expressions = straight_;
  for (int p = 0; p < 3; ++p)
    for (int q = 0; q < 3; ++q) {
      const auto& mixed = mixed_[static_cast<std::size_t>(p)][static_cast<std::size_t>(q)];
      expressions += a(p, q) * (mixed + mixed.transpose()) +
                     aa(p, q) * squared_[static_cast<std::size_t>(p)][static_cast<std::size_t>(q)];
    }
  matrix.topRightCorner(count, 3) = products.rightCols(3);
  matrix.bottomLeftCorner(3, count) = products.rightCols(3).transpose();
  right.resize(count + 3);
  right.head(count) = products.col(0);
  for (int i = 0; i < 3; ++i) {
    const Points& column = against[static_cast<std::size_t>(i) + 1];
    right[count + i] = column.cwiseProduct(residual).sum();
    for (int j = 0; j < 3; ++j)
      matrix(count + i, count + j) = column.cwiseProduct(against[static_cast<std::size_t>(j) + 1]).sum();
  }
}

Eigen::Matrix3d rotation_about(const Eigen::Vector3d& vector) {
  const double angle = vector.norm();
  if (angle == 0) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, vector / angle).toRotationMatrix();
}

Eigen::Vector3d rotation_vector(const Eigen::Matrix3d& rotation) {
  const Eigen::AngleAxisd turn(rotation);
  return turn.angle() * turn.axis();
}

}  // namespace mien::face_detail
