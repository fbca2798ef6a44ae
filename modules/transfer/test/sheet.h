#pragma once
#include <cmath>

#include "mien/transfer/surface.h"

namespace mien {

/// A curved sheet of columns x rows vertices over [-1, 1]^2; every mesh of it is the same surface. The centre
/// bulges out, so that no shift along it looks like another.
inline Surface sheet(int columns, int rows, double size = 1) {
  Surface surface;
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      const double x = 2.0 * i / (columns - 1) - 1, y = 2.0 * j / (rows - 1) - 1;
      surface.points.push_back(
          {size * x, size * y, size * (0.6 * std::exp(-3 * (x * x + y * y)) - 0.2 * x * x)});
    }
  for (int j = 0; j + 1 < rows; ++j)
    for (int i = 0; i + 1 < columns; ++i) {
      const auto v = static_cast<std::uint32_t>(j * columns + i), c = static_cast<std::uint32_t>(columns);
      surface.triangles.push_back({v, v + 1, v + c});
      surface.triangles.push_back({v + 1, v + c + 1, v + c});
    }
  return surface;
}

inline Mesh mesh_of(const Surface& surface) {
  Mesh mesh;
  for (const Point3& p : surface.points)
    mesh.positions.push_back({static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])});
  mesh.triangles = surface.triangles;
  return mesh;
}

}  // namespace mien
