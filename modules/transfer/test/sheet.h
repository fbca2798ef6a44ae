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

/// A sheet of `columns` columns cut along one of them: two pieces, the right one with copies of the vertices
/// on the cut behind all others, from the first row on.
inline Surface cut_along(const Surface& sheet, int columns, int column) {
  Surface cut = sheet;
  const auto num_rows = sheet.points.size() / static_cast<std::size_t>(columns);
  const auto column_of = [&](std::uint32_t v) { return static_cast<int>(v) % columns; };
  for (std::size_t j = 0; j < num_rows; ++j)
    cut.points.push_back(
        sheet.points[j * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column)]);
  for (Triangle& t : cut.triangles) {
    bool is_right = false;
    for (const std::uint32_t v : t) is_right = is_right || column_of(v) > column;
    for (std::uint32_t& v : t)
      if (is_right && column_of(v) == column)
        v = static_cast<std::uint32_t>(sheet.points.size()) + v / static_cast<std::uint32_t>(columns);
  }
  return cut;
}

inline Mesh mesh_of(const Surface& surface) {
  Mesh mesh;
  for (const Point3& p : surface.points)
    mesh.positions.push_back({static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])});
  mesh.triangles = surface.triangles;
  return mesh;
}

}  // namespace mien
