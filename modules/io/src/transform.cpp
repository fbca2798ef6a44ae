#include "transform.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mien::io {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

Quaternion about(int axis, double degrees) {
  Quaternion q = {0, 0, 0, std::cos(degrees * kDegree / 2)};
  q[axis] = std::sin(degrees * kDegree / 2);
  return q;
}

// Quaternion of an orthonormal matrix (upper 3x3), after Shepperd 1978: the largest of the four components
// comes from the diagonal, the others from sums and differences across it.
Quaternion from_matrix(const Matrix& m) {
  const auto at = [&](int row, int column) { return m[column * 4 + row]; };
  const double trace = at(0, 0) + at(1, 1) + at(2, 2);
  int largest = 3;
  double best = trace;
  for (int i = 0; i < 3; ++i)
    if (at(i, i) > best) best = at(i, i), largest = i;
  Quaternion q{};
  if (largest == 3) {
    q = {at(2, 1) - at(1, 2), at(0, 2) - at(2, 0), at(1, 0) - at(0, 1), 1 + trace};
  } else {
    const int i = largest, j = (i + 1) % 3, k = (i + 2) % 3;
    q[i] = 1 + at(i, i) - at(j, j) - at(k, k);
    q[j] = at(i, j) + at(j, i);
    q[k] = at(i, k) + at(k, i);
    q[3] = at(k, j) - at(j, k);
  }
  return normalised(q);
}

}  // namespace

Quaternion multiply(const Quaternion& a, const Quaternion& b) {
  return {a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1],
          a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0],
          a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3],
          a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2]};
}

Quaternion conjugate(const Quaternion& q) { return {-q[0], -q[1], -q[2], q[3]}; }

Quaternion normalised(const Quaternion& q) {
  const double size = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (!(size > 0) || !std::isfinite(size)) return kNoRotation;
  return {q[0] / size, q[1] / size, q[2] / size, q[3] / size};
}

Matrix multiply(const Matrix& a, const Matrix& b) {
  Matrix out{};
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row)
      for (int k = 0; k < 4; ++k) out[column * 4 + row] += a[k * 4 + row] * b[column * 4 + k];
  return out;
}

Vec3 transform_point(const Matrix& m, Vec3 p) {
  const auto row = [&](int r) {
    return static_cast<float>(m[r] * p.x + m[4 + r] * p.y + m[8 + r] * p.z + m[12 + r]);
  };
  return {row(0), row(1), row(2)};
}

Vec3 transform_vector(const Matrix& m, Vec3 v) {
  const auto row = [&](int r) { return static_cast<float>(m[r] * v.x + m[4 + r] * v.y + m[8 + r] * v.z); };
  return {row(0), row(1), row(2)};
}

Matrix normal_matrix(const Matrix& m) {
  Matrix out = kIdentity;
  for (int column = 0; column < 3; ++column) {
    const int c1 = (column + 1) % 3, c2 = (column + 2) % 3;
    for (int row = 0; row < 3; ++row) {
      const int r1 = (row + 1) % 3, r2 = (row + 2) % 3;
      out[column * 4 + row] = m[c1 * 4 + r1] * m[c2 * 4 + r2] - m[c1 * 4 + r2] * m[c2 * 4 + r1];
    }
  }
  return out;
}

double determinant(const Matrix& m) {
  const Matrix cofactors = normal_matrix(m);
  return m[0] * cofactors[0] + m[1] * cofactors[1] + m[2] * cofactors[2];
}

Matrix to_matrix(const Placement& placement) {
  const auto [x, y, z, w] = placement.rotation;
  const auto& s = placement.scale;
  const auto& t = placement.translation;
  return {(1 - 2 * (y * y + z * z)) * s[0],
          2 * (x * y + z * w) * s[0],
          2 * (x * z - y * w) * s[0],
          0,
          2 * (x * y - z * w) * s[1],
          (1 - 2 * (x * x + z * z)) * s[1],
          2 * (y * z + x * w) * s[1],
          0,
          2 * (x * z + y * w) * s[2],
          2 * (y * z - x * w) * s[2],
          (1 - 2 * (x * x + y * y)) * s[2],
          0,
          t[0],
          t[1],
          t[2],
          1};
}

std::optional<Placement> decompose(const Matrix& m) {
  Placement placement;
  placement.translation = {m[12], m[13], m[14]};
  const double sign = determinant(m) < 0 ? -1 : 1;
  Matrix rotation = kIdentity;
  for (int c = 0; c < 3; ++c) {
    const double size = std::hypot(m[c * 4], m[c * 4 + 1], m[c * 4 + 2]);
    if (!(size > 0) || !std::isfinite(size)) return std::nullopt;
    placement.scale[c] = c == 0 ? sign * size : size;
    for (int r = 0; r < 3; ++r) rotation[c * 4 + r] = m[c * 4 + r] / placement.scale[c];
  }
  placement.rotation = from_matrix(rotation);
  const Matrix back = to_matrix(placement);
  const double size = std::max({std::abs(placement.scale[0]), placement.scale[1], placement.scale[2]});
  for (int i = 0; i < 12; ++i)
    if (std::abs(back[i] - m[i]) > 1e-5 * size) return std::nullopt;
  return placement;
}

Quaternion head_rotation(double yaw_deg, double pitch_deg, double roll_deg) {
  // A positive rotation about x tips the face down, so pitch (up) enters with a minus.
  return multiply(multiply(about(1, yaw_deg), about(0, -pitch_deg)), about(2, roll_deg));
}

std::array<double, 3> head_angles(const Quaternion& rotation) {
  const auto [x, y, z, w] = normalised(rotation);
  // Entries of the matrix Ry(yaw) Rx(-pitch) Rz(roll).
  const double m12 = 2 * (y * z - x * w);
  const double pitch = std::asin(std::clamp(m12, -1.0, 1.0));
  const double yaw = std::atan2(2 * (x * z + y * w), 1 - 2 * (x * x + y * y));
  const double roll = std::atan2(2 * (x * y + z * w), 1 - 2 * (x * x + z * z));
  return {yaw / kDegree, pitch / kDegree, roll / kDegree};
}

}  // namespace mien::io
