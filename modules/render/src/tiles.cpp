#include "tiles.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mien::render_detail {
namespace {

constexpr int kTile = 64;  // samples; depth and triangle numbers of a tile fit into the first-level cache
constexpr std::uint32_t kNothing = std::numeric_limits<std::uint32_t>::max();

struct TileSamples {
  float inverse_depth[kTile * kTile];  // 0 = nothing yet
  std::uint32_t triangle[kTile * kTile];
};

// The edge functions as floats relative to the tile's upper left sample. The origin is the same for both
// triangles at an edge, and every operation below is symmetric in sign, so their values stay exactly
// opposite.
struct LocalEdges {
  float a[3], b[3], c[3], threshold[3];
  float depth_a, depth_b, depth_c;

  LocalEdges(const Triangle& t, int x0, int y0) {
    const double x = x0 + 0.5, y = y0 + 0.5;
    double sum_a = 0, sum_b = 0, sum_c = 0;
    for (int i = 0; i < 3; ++i) {
      const double value = t.a[i] * x + t.b[i] * y + t.c[i];
      a[i] = static_cast<float>(t.a[i]), b[i] = static_cast<float>(t.b[i]), c[i] = static_cast<float>(value);
      // A sample exactly on an edge belongs to one side of it.
      const bool owns_edge = t.a[i] > 0 || (t.a[i] == 0 && t.b[i] > 0);
      threshold[i] = owns_edge ? 0.0f : std::numeric_limits<float>::min();
      sum_a += t.a[i], sum_b += t.b[i], sum_c += value;
    }
    depth_a = static_cast<float>(sum_a * t.inverse_determinant);
    depth_b = static_cast<float>(sum_b * t.inverse_determinant);
    depth_c = static_cast<float>(sum_c * t.inverse_determinant);
  }
};

void draw_triangle(const Triangle& t, std::uint32_t number, int x0, int y0, int width, int height,
                   TileSamples& out) {
  const LocalEdges e(t, x0, y0);
  const int left = std::max(t.left - x0, 0), right = std::min(t.right - x0, width - 1);
  const int top = std::max(t.top - y0, 0), bottom = std::min(t.bottom - y0, height - 1);
  const float low = t.min_inverse_depth, high = t.max_inverse_depth;
  for (int y = top; y <= bottom; ++y) {
    const auto fy = static_cast<float>(y);
    const float r0 = e.b[0] * fy + e.c[0], r1 = e.b[1] * fy + e.c[1], r2 = e.b[2] * fy + e.c[2];
    const float rd = e.depth_b * fy + e.depth_c;
    float* depth = out.inverse_depth + y * kTile;
    std::uint32_t* seen = out.triangle + y * kTile;
    for (int x = left; x <= right; ++x) {
      const auto fx = static_cast<float>(x);
      const bool inside = (e.a[0] * fx + r0 >= e.threshold[0]) & (e.a[1] * fx + r1 >= e.threshold[1]) &
                          (e.a[2] * fx + r2 >= e.threshold[2]);
      if (!inside) continue;
      float d = e.depth_a * fx + rd;
      if (t.crosses_near && !(d <= high)) continue;  // nearer than the near plane
      d = std::min(std::max(d, low), high);
      if (d > depth[x]) depth[x] = d, seen[x] = number;
    }
  }
}

// Attributes of the triangle at a sample, by perspective-correct weights.
void write_attributes(const Scene& scene, const ViewVertices& vertices, const Triangle& t, int x, int y,
                      GBuffer& target, std::size_t at) {
  const double px = x + 0.5, py = y + 0.5;
  double e[3];
  for (int i = 0; i < 3; ++i) e[i] = std::max(0.0, t.a[i] * px + t.b[i] * py + t.c[i]);
  const double sum = e[0] + e[1] + e[2];
  float weight[3] = {1, 0, 0};
  if (sum > 0)
    for (int i = 0; i < 3; ++i) weight[i] = static_cast<float>(e[i] / sum);

  const SceneSurface& surface = scene.surfaces[t.surface];
  Vec3 normal = t.flat_normal;
  if (!surface.normals.empty()) {
    normal = weight[0] * vertices.normals[t.corner[0]] + weight[1] * vertices.normals[t.corner[1]] +
             weight[2] * vertices.normals[t.corner[2]];
    const float squared = dot(normal, normal);
    normal = squared > 1e-12f ? (t.normal_sign / std::sqrt(squared)) * normal : t.flat_normal;
  }
  target.nx[at] = normal.x, target.ny[at] = normal.y, target.nz[at] = normal.z;

  std::array<float, 3> color = surface.color;
  if (!surface.colors.empty()) {
    const std::size_t first = vertices.first[t.surface];
    const auto &c0 = surface.colors[t.corner[0] - first], &c1 = surface.colors[t.corner[1] - first],
               &c2 = surface.colors[t.corner[2] - first];
    for (std::size_t i = 0; i < 3; ++i) color[i] = weight[0] * c0[i] + weight[1] * c1[i] + weight[2] * c2[i];
  }
  target.red[at] = color[0], target.green[at] = color[1], target.blue[at] = color[2];
  target.gloss[at] = surface.gloss;
}

void clear_sample(GBuffer& target, std::size_t at) {
  target.depth[at] = kFarDepth;
  target.nx[at] = target.ny[at] = target.nz[at] = 0;
  target.red[at] = target.green[at] = target.blue[at] = target.gloss[at] = 0;
}

}  // namespace

TileBins bin_triangles(const std::vector<Triangle>& triangles, int width, int height) {
  TileBins bins;
  bins.columns = (width + kTile - 1) / kTile;
  bins.rows = (height + kTile - 1) / kTile;
  const auto for_tiles = [&bins](const Triangle& t, auto&& body) {
    if (t.left > t.right) return;
    for (int row = t.top / kTile; row <= t.bottom / kTile; ++row)
      for (int column = t.left / kTile; column <= t.right / kTile; ++column)
        body(static_cast<std::size_t>(row * bins.columns + column));
  };
  // Counting sort: it keeps the order of the triangles within a tile.
  bins.start.assign(static_cast<std::size_t>(bins.columns * bins.rows) + 1, 0);
  for (const Triangle& t : triangles) for_tiles(t, [&](std::size_t tile) { ++bins.start[tile + 1]; });
  for (std::size_t i = 1; i < bins.start.size(); ++i) bins.start[i] += bins.start[i - 1];
  bins.triangles.resize(bins.start.back());
  std::vector<std::size_t> next(bins.start.begin(), bins.start.end() - 1);
  for (std::size_t f = 0; f < triangles.size(); ++f)
    for_tiles(triangles[f],
              [&](std::size_t tile) { bins.triangles[next[tile]++] = static_cast<std::uint32_t>(f); });
  return bins;
}

void draw_tile(const Scene& scene, const ViewVertices& vertices, const std::vector<Triangle>& triangles,
               const TileBins& bins, int tile, GBuffer& target) {
  const int x0 = tile % bins.columns * kTile, y0 = tile / bins.columns * kTile;
  const int width = std::min(kTile, target.width - x0), height = std::min(kTile, target.height - y0);
  TileSamples samples;
  std::fill(std::begin(samples.inverse_depth), std::end(samples.inverse_depth), 0.0f);
  std::fill(std::begin(samples.triangle), std::end(samples.triangle), kNothing);
  const auto t = static_cast<std::size_t>(tile);
  for (std::size_t i = bins.start[t]; i < bins.start[t + 1]; ++i)
    draw_triangle(triangles[bins.triangles[i]], bins.triangles[i], x0, y0, width, height, samples);

  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const int sample = y * kTile + x;
      const std::size_t at = target.row(y0 + y) + static_cast<std::size_t>(x0 + x);
      if (samples.triangle[sample] == kNothing) {
        clear_sample(target, at);
        continue;
      }
      target.depth[at] = 1.0f / samples.inverse_depth[sample];
      write_attributes(scene, vertices, triangles[samples.triangle[sample]], x0 + x, y0 + y, target, at);
    }
}

}  // namespace mien::render_detail
