#pragma once
#include <array>
#include <optional>

#include "mien/core/vector.h"

namespace mien::io {

/// Unit quaternion x, y, z, w.
using Quaternion = std::array<double, 4>;
/// Column-major 4x4 matrix, as in glTF.
using Matrix = std::array<double, 16>;

inline constexpr Quaternion kNoRotation = {0, 0, 0, 1};
inline constexpr Matrix kIdentity = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

Quaternion multiply(const Quaternion& a, const Quaternion& b);
/// The inverse of a unit quaternion.
Quaternion conjugate(const Quaternion& q);
/// Unit length; no rotation when the length is zero or not finite.
Quaternion normalised(const Quaternion& q);

Matrix multiply(const Matrix& a, const Matrix& b);
Vec3 transform_point(const Matrix& m, Vec3 p);
Vec3 transform_vector(const Matrix& m, Vec3 v);
/// Cofactors of the upper 3x3: turns normals (up to length; mirrored matrices flip the sign of the
/// determinant).
Matrix normal_matrix(const Matrix& m);
/// Of the upper 3x3.
double determinant(const Matrix& m);

struct Placement {
  std::array<double, 3> translation = {0, 0, 0};
  Quaternion rotation = kNoRotation;
  std::array<double, 3> scale = {1, 1, 1};
};

/// translation * rotation * scale.
Matrix to_matrix(const Placement& placement);
/// The placement that to_matrix() turns back into `m`; nothing when m is sheared, singular or not affine.
std::optional<Placement> decompose(const Matrix& m);

/// Rotation of a head turned by the angles of head_names(): yaw about +y, then pitch (up) about the turned x,
/// then roll (right ear down) about the turned z; degrees. +x is the character's left, +z out of the face.
Quaternion head_rotation(double yaw_deg, double pitch_deg, double roll_deg);
/// Yaw, pitch and roll in degrees of a rotation; pitch within +-90.
std::array<double, 3> head_angles(const Quaternion& rotation);

}  // namespace mien::io
