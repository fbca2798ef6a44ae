#include <Eigen/Dense>

#include "matrices.h"
#include "mien/base/contract.h"
#include "mien/transfer/registration.h"

namespace mien {

Point3 Similarity::operator()(const Point3& point) const { return scale * (rotation * point) + offset; }

Similarity best_similarity(std::span<const Point3> from, std::span<const Point3> to) {
  contract(from.size() == to.size() && !from.empty(), "best_similarity: sizes differ");
  Point3 from_mean{}, to_mean{};
  const double share = 1.0 / static_cast<double>(from.size());
  for (std::size_t i = 0; i < from.size(); ++i) {
    from_mean = from_mean + share * from[i];
    to_mean = to_mean + share * to[i];
  }
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double spread = 0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const Point3 a = from[i] - from_mean, b = to[i] - to_mean;
    spread += dot(a, a);
    covariance += Eigen::Vector3d(b[0], b[1], b[2]) * Eigen::RowVector3d(a[0], a[1], a[2]);
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d signs(1, 1, 1);
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0) signs[2] = -1;
  const Eigen::Matrix3d rotation = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  Similarity result;
  if (spread > 0) result.scale = svd.singularValues().dot(signs) / spread;
  if (!(result.scale > 0)) result.scale = 1;
  for (int i = 0; i < 3; ++i)
    result.rotation[static_cast<std::size_t>(i)] = {rotation(i, 0), rotation(i, 1), rotation(i, 2)};
  result.offset = to_mean - result.scale * (result.rotation * from_mean);
  return result;
}

}  // namespace mien
