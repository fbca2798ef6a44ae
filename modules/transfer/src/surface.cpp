#include "mien/transfer/surface.h"

#include <numeric>

#include "vectors.h"

namespace mien {

Surface surface_of(const Mesh& mesh) {
  Surface surface;
  surface.points.reserve(mesh.positions.size());
  for (const Vec3& p : mesh.positions) surface.points.push_back({p.x, p.y, p.z});
  surface.triangles = mesh.triangles;
  return surface;
}

SurfacePart part_without(const Surface& whole, const std::vector<bool>& excluded) {
  constexpr std::uint32_t kNone = ~0u;
  std::vector<std::uint32_t> place(whole.points.size(), kNone);
  SurfacePart part;
  const auto keeps = [&](const Triangle& t) { return !excluded[t[0]] && !excluded[t[1]] && !excluded[t[2]]; };
  for (const Triangle& t : whole.triangles)
    if (keeps(t))
      for (const std::uint32_t v : t) place[v] = 0;
  for (std::uint32_t v = 0; v < place.size(); ++v) {
    if (place[v] == kNone) continue;
    place[v] = static_cast<std::uint32_t>(part.whole.size());
    part.whole.push_back(v);
    part.surface.points.push_back(whole.points[v]);
  }
  for (const Triangle& t : whole.triangles)
    if (keeps(t)) part.surface.triangles.push_back({place[t[0]], place[t[1]], place[t[2]]});
  return part;
}

std::vector<std::uint32_t> components(std::size_t num_vertices, std::span<const Triangle> triangles) {
  std::vector<std::uint32_t> parent(num_vertices);
  std::iota(parent.begin(), parent.end(), 0u);
  const auto root = [&](std::uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const Triangle& t : triangles)
    for (const int corner : {1, 2}) {
      const std::uint32_t a = root(t[0]), b = root(t[corner]);
      parent[std::max(a, b)] = std::min(a, b);  // the root is the first vertex
    }
  std::vector<std::uint32_t> number(num_vertices);
  std::uint32_t count = 0;
  for (std::uint32_t v = 0; v < num_vertices; ++v) {
    const std::uint32_t r = root(v);
    number[v] = r == v ? count++ : number[r];
  }
  return number;
}

namespace {

Point3 area_vector(const Surface& surface, const Triangle& t) {
  return cross(surface.points[t[1]] - surface.points[t[0]], surface.points[t[2]] - surface.points[t[0]]);
}

}  // namespace

std::vector<Point3> triangle_normals(const Surface& surface) {
  std::vector<Point3> normals;
  normals.reserve(surface.triangles.size());
  for (const Triangle& t : surface.triangles) normals.push_back(unit(area_vector(surface, t)));
  return normals;
}

std::vector<Point3> point_normals(const Surface& surface) {
  std::vector<Point3> normals(surface.points.size(), Point3{});
  for (const Triangle& t : surface.triangles) {
    const Point3 area = area_vector(surface, t);
    for (const std::uint32_t v : t) normals[v] = normals[v] + area;
  }
  for (Point3& n : normals) n = unit(n);
  return normals;
}

std::vector<Point3> centroids(const Surface& surface) {
  std::vector<Point3> centres;
  centres.reserve(surface.triangles.size());
  for (const Triangle& t : surface.triangles)
    centres.push_back((1.0 / 3) * (surface.points[t[0]] + surface.points[t[1]] + surface.points[t[2]]));
  return centres;
}

}  // namespace mien
