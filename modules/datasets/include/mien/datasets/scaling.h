#pragma once
#include <array>
#include <span>
#include <vector>

#include "mien/base/result.h"
#include "mien/core/mesh.h"
#include "mien/core/motion.h"

// The scalings that turn recorded meshes into what the papers' models see.
namespace mien {

/// v' = (v - centre) / size, axis by axis.
struct AxisScale {
  std::array<double, 3> centre{}, size{1, 1, 1};
};

/// FaceXHuBERT's scaling of a subject: centre and box of the unscaled template (specification, section 4).
/// The box of the scaled template spans 1 on every axis; the face loses its proportions.
/// @param neutral  [3 V] Errors (Errc::input): no vertex, an axis without extent, numbers that are not
/// finite.
Result<AxisScale> box_scale(std::span<const float> neutral);

/// Multiface's: every axis to [-1, 1], with the constants of the authors' script (FaceDiffuser
/// specification, 10.3).
AxisScale multiface_scale();

/// In place. @param values  [N, 3 V]
void apply_scale(const AxisScale& scale, std::span<float> values);
/// The inverse: back to the units that were recorded.
void undo_scale(const AxisScale& scale, std::span<float> values);

/// FaceDiffuser's (CodeTalker's) preparation of a BIWI frame: turned by half a circle about x, moved so that
/// the mean of the vertices is the origin, divided by the square root of the surface's area
/// (specification, 10.1; the mixed Voronoi areas of the vertices of a triangle mesh add up to the area of its
/// triangles). In place.
/// @param frame  [3 V] @pre every triangle index below V
/// Errors (Errc::input): a surface without area.
Status scale_by_area(std::span<const std::array<std::uint32_t, 3>> triangles, std::span<float> frame);

}  // namespace mien
