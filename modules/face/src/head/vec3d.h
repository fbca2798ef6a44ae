#pragma once
#include <cmath>
#include <vector>

namespace mien::head {

/// A point or offset in double precision. The head is built in centimetres (x left, y up, z forward); only
/// the finished character is in metres and single precision.
struct Vec3d {
  double x = 0, y = 0, z = 0;

  friend Vec3d operator+(Vec3d a, Vec3d b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Vec3d operator-(Vec3d a, Vec3d b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Vec3d operator*(double s, Vec3d a) { return {s * a.x, s * a.y, s * a.z}; }
  Vec3d& operator+=(Vec3d b) { return *this = *this + b; }
};

inline double dot(Vec3d a, Vec3d b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec3d cross(Vec3d a, Vec3d b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double length(Vec3d a) { return std::sqrt(dot(a, a)); }
/// The same vector seen in the mirror of the symmetry plane x = 0.
inline Vec3d mirrored(Vec3d a) { return {-a.x, a.y, a.z}; }

/// Offsets of all vertices of a mesh.
using Offsets = std::vector<Vec3d>;

}  // namespace mien::head
