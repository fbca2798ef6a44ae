#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "mien/core/vector.h"

namespace mien {

/// One mesh to draw. The arrays belong to the caller and must outlive the picture.
struct SceneSurface {
  std::span<const Vec3> positions;                          // [V] metres
  std::span<const std::array<std::uint32_t, 3>> triangles;  // [F] every index below V
  std::span<const Vec3> normals;                            // [V], or empty: each triangle is flat
  std::span<const std::array<float, 4>> colors;     // [V] linear RGBA (A is not used), or empty: `color`
  std::array<float, 3> color{0.72f, 0.52f, 0.43f};  ///< linear RGB
  float gloss = 0.1f;                               ///< strength of the highlight, 0 (matt) to 1 (wet)
};

struct Scene {
  std::vector<SceneSurface> surfaces;
};

}  // namespace mien
