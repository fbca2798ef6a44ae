#include "head/thin_plate.h"

#include <algorithm>

#include "head/constrained_solve.h"

namespace mien::head {

struct ThinPlate::Energy {
  ConstrainedSolve::Matrix matrix;
};

ThinPlate::ThinPlate(std::span<const Vec3d> positions, std::span<const Triangle> triangles)
    : energy_(std::make_unique<Energy>()) {
  // Clamped: slivers would otherwise give negative or huge weights, and tiny vertices a huge bending
  // resistance.
  constexpr double kMinWeight = 0.03, kMaxWeight = 2.0, kMinArea = 0.004, kMembrane = 0.06, kTinyArea = 1e-9;
  const auto n = static_cast<int>(positions.size());
  Eigen::VectorXd area = Eigen::VectorXd::Zero(n);
  std::vector<Eigen::Triplet<double>> entries;
  for (const Triangle& triangle : triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto a = static_cast<int>(triangle[k]);
      const auto b = static_cast<int>(triangle[(k + 1) % 3]), c = static_cast<int>(triangle[(k + 2) % 3]);
      const Vec3d u = positions[triangle[(k + 1) % 3]] - positions[triangle[k]];
      const Vec3d v = positions[triangle[(k + 2) % 3]] - positions[triangle[k]];
      const double twice_area = length(cross(u, v)) + kTinyArea;
      const double weight = std::clamp(0.5 * dot(u, v) / twice_area, kMinWeight, kMaxWeight);
      entries.emplace_back(b, c, -weight);
      entries.emplace_back(c, b, -weight);
      entries.emplace_back(b, b, weight);
      entries.emplace_back(c, c, weight);
      area[a] += twice_area / 6;
    }
  ConstrainedSolve::Matrix laplacian(n, n);
  laplacian.setFromTriplets(entries.begin(), entries.end());
  const Eigen::VectorXd inverse_area = area.cwiseMax(kMinArea).cwiseInverse();
  const ConstrainedSolve::Matrix scaled = inverse_area.asDiagonal() * laplacian;
  const ConstrainedSolve::Matrix bending = laplacian * scaled;
  energy_->matrix = bending + kMembrane * laplacian;
}

ThinPlate::~ThinPlate() = default;

void ThinPlate::spread(const std::vector<bool>& known, std::span<Offsets* const> fields) const {
  const ConstrainedSolve solve(energy_->matrix, known);
  const auto n = static_cast<Eigen::Index>(known.size());
  Eigen::MatrixXd x(n, static_cast<Eigen::Index>(3 * fields.size()));
  for (std::size_t f = 0; f < fields.size(); ++f)
    for (Eigen::Index i = 0; i < n; ++i) {
      const Vec3d& d = (*fields[f])[static_cast<std::size_t>(i)];
      x.row(i).segment<3>(static_cast<Eigen::Index>(3 * f)) << d.x, d.y, d.z;
    }
  solve.fill(x);
  for (std::size_t f = 0; f < fields.size(); ++f)
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto d = x.row(i).segment<3>(static_cast<Eigen::Index>(3 * f));
      (*fields[f])[static_cast<std::size_t>(i)] = {d[0], d[1], d[2]};
    }
}

}  // namespace mien::head
