#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "mien/core/vector.h"

namespace mien {

/// Triangles over shared vertices. +x is the character's left, +y up, +z out of the face; counter-clockwise seen from
/// outside.
struct Mesh {
  std::vector<Vec3> positions;                          // [V] metres
  std::vector<std::array<std::uint32_t, 3>> triangles;  // [F]
  std::vector<Vec3> normals;                            // [V] unit length, or empty
  std::vector<std::array<float, 4>> colors;             // [V] linear RGBA, or empty
};

/// Area-weighted vertex normals, unit length; a vertex without area gets +z.
std::vector<Vec3> vertex_normals(const std::vector<Vec3>& positions,
                                 const std::vector<std::array<std::uint32_t, 3>>& triangles);

}  // namespace mien
