#pragma once
#include <cstdint>
#include <vector>

#include "mien/render/camera.h"
#include "mien/render/scene.h"

namespace mien::render_detail {

/// Camera axes and the mapping from view space (right, up, away; metres) to samples of the picture:
/// column = centre_x + focal * x / z, line = centre_y - focal * y / z.
struct Projection {
  Vec3 origin, right, up, away;
  float focal = 1;  // samples
  float centre_x = 0, centre_y = 0;
  float near_m = 0.01f;

  [[nodiscard]] Vec3 rotate(Vec3 v) const { return {dot(v, right), dot(v, up), dot(v, away)}; }
};

/// For a picture of width x height samples. A camera that looks nowhere looks along -z.
Projection make_projection(const Camera& camera, int width, int height);

/// A triangle set up for drawing by edge functions in homogeneous coordinates (Olano and Greer, "Triangle
/// scan conversion using 2D homogeneous coordinates", 1997): e_i(x, y) = a_i x + b_i y + c_i is not negative
/// inside, and e_i / (e_0 + e_1 + e_2) is the perspective-correct barycentric weight of corner i. No clipping
/// is needed.
struct Triangle {
  double a[3], b[3], c[3];
  double inverse_determinant;  // times the sum of the e_i: 1 / depth
  std::uint32_t corner[3];     // indices into ViewVertices
  std::uint32_t surface;
  float min_inverse_depth, max_inverse_depth;  // of the corners: bounds that rounding must not leave
  float normal_sign;                           // turns the corners' normals towards the viewer
  Vec3 flat_normal;                            // unit, towards the viewer
  bool crosses_near;                           // a corner is nearer than the near plane
  int left, right, top, bottom;                // samples it may cover, inclusive; left > right: not drawn
};

/// All vertices of a scene in view space, surfaces one after the other.
struct ViewVertices {
  std::vector<Vec3> positions, normals;  // normals keep their length; zero where the surface has none
  std::vector<std::size_t> first;        // of each surface
};

void to_view(const Scene& scene, const Projection& projection, int num_threads, ViewVertices& out);

/// All triangles in scene order; those that are not seen have left > right.
void set_up_triangles(const Scene& scene, const ViewVertices& vertices, const Projection& projection,
                      int width, int height, int num_threads, std::vector<Triangle>& out);

}  // namespace mien::render_detail
