#pragma once
#include <cstdint>
#include <vector>

#include "g_buffer.h"
#include "projection.h"

namespace mien::render_detail {

/// Which triangles touch which tile of the picture, in scene order.
struct TileBins {
  int columns = 0, rows = 0;
  std::vector<std::size_t> start;        // [columns * rows + 1] into `triangles`
  std::vector<std::uint32_t> triangles;  // indices
};

TileBins bin_triangles(const std::vector<Triangle>& triangles, int width, int height);

/// Draws the triangles of one tile into its part of `target`: visibility first, then the attributes of what
/// is seen. Tiles do not touch each other's samples.
void draw_tile(const Scene& scene, const ViewVertices& vertices, const std::vector<Triangle>& triangles,
               const TileBins& bins, int tile, GBuffer& target);

}  // namespace mien::render_detail
