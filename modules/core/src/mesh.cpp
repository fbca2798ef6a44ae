#include "mien/core/mesh.h"

namespace mien {

std::vector<Vec3> vertex_normals(const std::vector<Vec3>& positions,
                                 const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  std::vector<Vec3> normals(positions.size());
  for (const auto& [a, b, c] : triangles) {
    // The cross product is twice the area times the unit normal: summing it weighs by area.
    const Vec3 n = cross(positions[b] - positions[a], positions[c] - positions[a]);
    for (const auto v : {a, b, c}) normals[v] += n;
  }
  for (Vec3& n : normals) {
    const float size = length(n);
    n = size > 0 ? (1.0f / size) * n : Vec3{0, 0, 1};
  }
  return normals;
}

}  // namespace mien
