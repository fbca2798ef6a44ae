#pragma once
#include "mien/transfer/deformation_transfer.h"
#include "vectors.h"

namespace mien {

inline Point3 operator*(const Matrix3& m, const Point3& v) {
  return {dot(m[0], v), dot(m[1], v), dot(m[2], v)};
}
inline constexpr Matrix3 kIdentity = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

/// The matrix with columns a, b, c.
inline Matrix3 from_columns(const Point3& a, const Point3& b, const Point3& c) {
  return {{{a[0], b[0], c[0]}, {a[1], b[1], c[1]}, {a[2], b[2], c[2]}}};
}

/// Rows of [a b c]^-1. False when the columns do not span space.
inline bool invert_columns(const Point3& a, const Point3& b, const Point3& c, Matrix3& inverse) {
  const Point3 bc = cross(b, c);
  const double volume = dot(a, bc);
  if (!(std::abs(volume) > 0)) return false;
  inverse = {(1 / volume) * bc, (1 / volume) * cross(c, a), (1 / volume) * cross(a, b)};
  return true;
}

inline Matrix3 operator*(const Matrix3& a, const Matrix3& b) {
  Matrix3 product{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      product[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
  return product;
}

/// Gradients g of the three barycentric functions of a triangle: sum of v_i g_i^T is the deformation gradient
/// within its plane. False for a triangle without area.
inline bool barycentric_gradients(const Surface& surface, const Triangle& t, std::array<Point3, 3>& g) {
  const Point3 e1 = surface.points[t[1]] - surface.points[t[0]],
               e2 = surface.points[t[2]] - surface.points[t[0]], area = cross(e1, e2);
  const double square = dot(area, area);
  // Slivers whose height is below rounding have no direction.
  if (!(square > 1e-28 * dot(e1, e1) * dot(e2, e2))) return false;
  g[1] = (1 / square) * cross(e2, area);
  g[2] = (1 / square) * cross(area, e1);
  g[0] = Point3{} - (g[1] + g[2]);
  return true;
}

}  // namespace mien
