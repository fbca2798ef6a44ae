#include "projection.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mien/base/parallel.h"

namespace mien::render_detail {
namespace {

constexpr std::int64_t kBlock = 4096;  // vertices or triangles handed to a thread at a time

Vec3 unit_or(Vec3 v, Vec3 otherwise) {
  const float size = length(v);
  return size > 0 && std::isfinite(size) ? (1.0f / size) * v : otherwise;
}

bool is_finite(Vec3 p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

void for_blocks(int num_threads, std::size_t count,
                const std::function<void(std::size_t, std::size_t)>& body) {
  const auto total = static_cast<std::int64_t>(count);
  parallel_for(num_threads, (total + kBlock - 1) / kBlock, [&](std::int64_t block) {
    body(static_cast<std::size_t>(block * kBlock),
         static_cast<std::size_t>(std::min(total, (block + 1) * kBlock)));
  });
}

// Range of sample indices whose centres lie in [low, high], within 0 ... size-1. Written so that huge values
// survive.
void sample_range(double low, double high, int size, int& first, int& last) {
  first = static_cast<int>(std::clamp(std::ceil(low - 0.5), 0.0, static_cast<double>(size)));
  last = static_cast<int>(std::clamp(std::floor(high - 0.5), -1.0, static_cast<double>(size - 1)));
}

void set_up(Triangle& t, const ViewVertices& vertices, const Projection& projection, int width, int height) {
  t.left = 1, t.right = 0, t.top = 1, t.bottom = 0;
  const Vec3 p[3] = {vertices.positions[t.corner[0]], vertices.positions[t.corner[1]],
                     vertices.positions[t.corner[2]]};
  if (!is_finite(p[0]) || !is_finite(p[1]) || !is_finite(p[2])) return;
  const float nearest = std::min({p[0].z, p[1].z, p[2].z}), farthest = std::max({p[0].z, p[1].z, p[2].z});
  if (farthest <= projection.near_m) return;

  const Vec3 face = cross(p[1] - p[0], p[2] - p[0]);
  const float size = length(face);
  if (!(size > 0) || !std::isfinite(size)) return;
  t.flat_normal = (dot(face, p[0]) > 0 ? -1.0f / size : 1.0f / size) * face;
  const Vec3 corners =
      vertices.normals[t.corner[0]] + vertices.normals[t.corner[1]] + vertices.normals[t.corner[2]];
  t.normal_sign = dot(corners, t.flat_normal) < 0 ? -1.0f : 1.0f;

  double x[3], y[3], w[3];
  for (int i = 0; i < 3; ++i) {
    w[i] = static_cast<double>(p[i].z);
    x[i] = static_cast<double>(projection.focal) * static_cast<double>(p[i].x) +
           static_cast<double>(projection.centre_x) * w[i];
    y[i] = static_cast<double>(projection.centre_y) * w[i] -
           static_cast<double>(projection.focal) * static_cast<double>(p[i].y);
  }
  for (int i = 0; i < 3; ++i) {
    // Two triangles at a common edge get exactly opposite numbers here, so no sample is drawn twice or
    // missed.
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    t.a[i] = y[j] * w[k] - w[j] * y[k];
    t.b[i] = w[j] * x[k] - x[j] * w[k];
    t.c[i] = x[j] * y[k] - y[j] * x[k];
  }
  const double determinant = x[0] * t.a[0] + y[0] * t.b[0] + w[0] * t.c[0];
  if (determinant == 0 || !std::isfinite(determinant)) return;
  if (determinant < 0)
    for (int i = 0; i < 3; ++i) t.a[i] = -t.a[i], t.b[i] = -t.b[i], t.c[i] = -t.c[i];
  t.inverse_determinant = 1 / std::abs(determinant);

  t.crosses_near = !(nearest > projection.near_m);
  if (!t.crosses_near) {
    t.min_inverse_depth = 1 / farthest, t.max_inverse_depth = 1 / nearest;
    const double u[3] = {x[0] / w[0], x[1] / w[1], x[2] / w[2]},
                 v[3] = {y[0] / w[0], y[1] / w[1], y[2] / w[2]};
    sample_range(std::min({u[0], u[1], u[2]}), std::max({u[0], u[1], u[2]}), width, t.left, t.right);
    sample_range(std::min({v[0], v[1], v[2]}), std::max({v[0], v[1], v[2]}), height, t.top, t.bottom);
    if (t.top > t.bottom) t.left = 1, t.right = 0;
  } else {  // reaches behind the camera: its outline on the picture is not bounded by its corners
    t.min_inverse_depth = 1 / farthest, t.max_inverse_depth = 1 / projection.near_m;
    t.left = 0, t.right = width - 1, t.top = 0, t.bottom = height - 1;
  }
}

}  // namespace

Projection make_projection(const Camera& camera, int width, int height) {
  Projection p;
  p.origin = camera.position;
  p.away = unit_or(camera.target - camera.position, {0, 0, -1});
  p.right = unit_or(cross(p.away, camera.up), unit_or(cross(p.away, {0, 0, 1}), {1, 0, 0}));
  p.up = cross(p.right, p.away);
  const double tangent = std::tan(static_cast<double>(camera.vertical_fov_deg) * std::numbers::pi / 360);
  p.focal = static_cast<float>(0.5 * height / std::max(tangent, 1e-6));
  p.centre_x = 0.5f * static_cast<float>(width);
  p.centre_y = 0.5f * static_cast<float>(height);
  p.near_m = std::max(camera.near_m, 1e-6f);
  return p;
}

void to_view(const Scene& scene, const Projection& projection, int num_threads, ViewVertices& out) {
  out.first.clear();
  std::size_t count = 0;
  for (const SceneSurface& surface : scene.surfaces) {
    out.first.push_back(count);
    count += surface.positions.size();
  }
  out.positions.resize(count);
  out.normals.resize(count);
  for (std::size_t s = 0; s < scene.surfaces.size(); ++s) {
    const SceneSurface& surface = scene.surfaces[s];
    for_blocks(num_threads, surface.positions.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) {
        out.positions[out.first[s] + v] = projection.rotate(surface.positions[v] - projection.origin);
        out.normals[out.first[s] + v] =
            surface.normals.empty() ? Vec3{} : projection.rotate(surface.normals[v]);
      }
    });
  }
}

void set_up_triangles(const Scene& scene, const ViewVertices& vertices, const Projection& projection,
                      int width, int height, int num_threads, std::vector<Triangle>& out) {
  std::size_t count = 0;
  for (const SceneSurface& surface : scene.surfaces) count += surface.triangles.size();
  out.resize(count);
  std::size_t first = 0;
  for (std::size_t s = 0; s < scene.surfaces.size(); ++s) {
    const auto triangles = scene.surfaces[s].triangles;
    for_blocks(num_threads, triangles.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t f = begin; f < end; ++f) {
        Triangle& t = out[first + f];
        t.surface = static_cast<std::uint32_t>(s);
        for (std::size_t i = 0; i < 3; ++i)
          t.corner[i] = static_cast<std::uint32_t>(vertices.first[s] + triangles[f][i]);
        set_up(t, vertices, projection, width, height);
      }
    });
    first += triangles.size();
  }
}

}  // namespace mien::render_detail
