#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "mien/core/flame_model.h"

namespace mien::face_detail {

/// FLAME with nothing but expression and jaw, at some of its vertices:
///
///   P = neutral + S e + Q vec(A),   V = P + w (P - J(e)) A^T,   A = R - I
///
/// S are the expression directions, Q the corrections of the jaw's nine pose features, w the share of the jaw
/// and of the joints below it, J the jaw's joint, linear in e. Points are rows. What Gauss-Newton needs of
/// the E columns dV/de = S + A T, T = w (S - dJ), is put together from inner products that are made once, so
/// that a step costs a few products of [V, E] with [V, 4] and never one of [3 V, E] with itself.
class FlameEquations {
 public:
  using Points = Eigen::Matrix<double, Eigen::Dynamic, 3>;

  FlameEquations(const FlameModel& model, const std::vector<std::uint32_t>& vertices,
                 std::int64_t num_expressions);

  [[nodiscard]] std::int64_t num_expressions() const { return directions_[0].cols(); }
  [[nodiscard]] std::int64_t num_vertices() const { return neutral_.rows(); }

  struct State {
    Eigen::VectorXd expression;
    Eigen::Matrix3d rotation;
    Points around_jaw;  ///< w (P - J)
    Points vertices;    ///< V
  };
  /// @param state  expression and rotation are given, the rest is made of them
  void pose(State& state) const;

  /// The normal equations of a step in expression and jaw (rotation vector, composed from the left), without
  /// the cost of expressions. @param residual  target - V
  void linearise(const State& state, const Points& residual, Eigen::MatrixXd& matrix,
                 Eigen::VectorXd& right) const;

 private:
  Points neutral_;                             // [V]
  std::array<Eigen::MatrixXd, 3> directions_;  // [V, E] of x, y, z
  std::array<Eigen::MatrixXd, 3> turned_;      // [V, E]: T
  std::array<Points, 9> corrections_;          // [V] per feature
  Eigen::VectorXd share_;                      // [V]
  Eigen::RowVector3d joint_;
  Eigen::MatrixXd joint_directions_;                               // [E, 3]
  Eigen::MatrixXd straight_;                                       // sum over a of S_a^T S_a
  std::array<std::array<Eigen::MatrixXd, 3>, 3> mixed_, squared_;  // S_a^T T_b and T_a^T T_b
};

/// The rotation of a vector's length about it, and back; the length is at most pi.
Eigen::Matrix3d rotation_about(const Eigen::Vector3d& vector);
Eigen::Vector3d rotation_vector(const Eigen::Matrix3d& rotation);

}  // namespace mien::face_detail
