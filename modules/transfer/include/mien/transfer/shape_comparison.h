#pragma once
#include <span>
#include <string>
#include <vector>

#include "mien/core/blendshape_rig.h"

namespace mien {

/// How far a shape is from another one for the same vertices. An empty comparison has no vertices.
struct ShapeComparison {
  std::string name;
  double mean_mm = 0, max_mm = 0;  ///< distance between the two, over the vertices that count
  double largest_mm = 0;           ///< farthest that the other shape moves one of them
  double cosine = 0;  ///< of the angle between the two as vectors of all offsets; 0 if one is zero

  /// Of the other shape's largest offset, in percent; 0 when that moves nothing.
  [[nodiscard]] double mean_percent() const { return largest_mm > 0 ? 100 * mean_mm / largest_mm : 0; }
  [[nodiscard]] double max_percent() const { return largest_mm > 0 ? 100 * max_mm / largest_mm : 0; }
};

/// Shapes against those of the same name in `others`; names that only one side has are left out.
/// @param excluded  [V] vertices that do not count
/// @pre vertices of all shapes lie below V
std::vector<ShapeComparison> compare_shapes(std::span<const Blendshape> shapes,
                                            std::span<const Blendshape> others,
                                            const std::vector<bool>& excluded);

}  // namespace mien
