#include <utility>

#include "head/parts.h"

namespace mien::head {

std::vector<Triangle> sheet_triangles(int rows, int columns, bool closed) {
  std::vector<Triangle> triangles;
  const auto vertex = [&](int row, int column) {
    return static_cast<std::uint32_t>(row * columns + column % columns);
  };
  for (int row = 0; row + 1 < rows; ++row)
    for (int column = 0; column < (closed ? columns : columns - 1); ++column) {
      const auto a = vertex(row, column), b = vertex(row, column + 1);
      const auto c = vertex(row + 1, column + 1), d = vertex(row + 1, column);
      triangles.push_back({a, b, c});
      triangles.push_back({a, c, d});
    }
  return triangles;
}

void turn_around(std::vector<Triangle>& triangles) {
  for (Triangle& t : triangles) std::swap(t[1], t[2]);
}

}  // namespace mien::head
