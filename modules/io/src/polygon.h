#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "mien/core/mesh.h"

namespace mien::io {

/// Triangles of a polygon, all from its first corner. @pre three corners or more
inline void add_fan(std::span<const std::uint32_t> corners,
                    std::vector<std::array<std::uint32_t, 3>>& triangles) {
  for (std::size_t i = 2; i < corners.size(); ++i)
    triangles.push_back({corners[0], corners[i - 1], corners[i]});
}

/// A vertex that a triangle names and the mesh does not have.
inline std::optional<std::uint32_t> stray_vertex(const Mesh& mesh) {
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t v : triangle)
      if (v >= mesh.positions.size()) return v;
  return std::nullopt;
}

}  // namespace mien::io
