#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "mien/core/mesh.h"

namespace mien {

using Point3 = std::array<double, 3>;
using Triangle = std::array<std::uint32_t, 3>;

/// Triangles in double precision, for solves. Any unit of length.
struct Surface {
  std::vector<Point3> points;       // [V]
  std::vector<Triangle> triangles;  // [F] indices below V
};

Surface surface_of(const Mesh& mesh);

/// A part of a surface: what is left without some vertices and their triangles.
struct SurfacePart {
  Surface surface;
  std::vector<std::uint32_t> whole;  ///< [V of the part] vertex of the whole surface
};
/// Vertices without a triangle are left out too. @param excluded  [V of the whole]
SurfacePart part_without(const Surface& whole, const std::vector<bool>& excluded);

/// [V] number of the connected component of each vertex, in the order of their first vertices. Vertices of no
/// triangle are components of their own.
std::vector<std::uint32_t> components(std::size_t num_vertices, std::span<const Triangle> triangles);

/// Two vertices at the same place, a < b.
struct Tie {
  std::uint32_t a = 0, b = 0;
  friend auto operator<=>(const Tie&, const Tie&) = default;
};
/// Vertices on borders that lie together where the surface goes on on the other side: copies along a seam of
/// textures, borders of pieces that touch. Together is within a hundredth of the mean edge; goes on: normals
/// within 60 degrees, which leaves lips that meet apart. All copies of a place hang together.
std::vector<Tie> touching_vertices(const Surface& surface);

/// [F] unit normals; zero for triangles without area.
std::vector<Point3> triangle_normals(const Surface& surface);
/// [V] area-weighted unit normals; zero where there is none.
std::vector<Point3> point_normals(const Surface& surface);
/// [F]
std::vector<Point3> centroids(const Surface& surface);

}  // namespace mien
