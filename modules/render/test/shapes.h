#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "mien/render/scene.h"

namespace mien::render_test {

/// A mesh that owns its arrays.
struct Solid {
  std::vector<Vec3> positions, normals;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::array<float, 4>> colors;

  [[nodiscard]] SceneSurface surface(float gloss = 0) const {
    SceneSurface s;
    s.positions = positions;
    s.normals = normals;
    s.triangles = triangles;
    s.colors = colors;
    s.gloss = gloss;
    return s;
  }
};

/// One triangle that faces +z, or any other plane figure: corners counter-clockwise seen from +z, fan
/// triangulated.
inline Solid polygon(std::vector<Vec3> corners, std::array<float, 4> color = {0.5f, 0.5f, 0.5f, 1}) {
  Solid s;
  s.positions = std::move(corners);
  s.normals.assign(s.positions.size(), Vec3{0, 0, 1});
  s.colors.assign(s.positions.size(), color);
  for (std::uint32_t i = 2; i < s.positions.size(); ++i) s.triangles.push_back({0, i - 1, i});
  return s;
}

/// A ball with `rings` bands from pole to pole, coloured by position; smooth normals.
inline Solid ball(Vec3 centre, float radius, int rings) {
  Solid s;
  const int columns = 2 * rings;
  for (int i = 0; i <= rings; ++i)
    for (int j = 0; j < columns; ++j) {
      const double phi = 3.14159265358979 * i / rings, theta = 6.28318530717959 * j / columns;
      const Vec3 n{static_cast<float>(std::sin(phi) * std::sin(theta)), static_cast<float>(std::cos(phi)),
                   static_cast<float>(std::sin(phi) * std::cos(theta))};
      s.positions.push_back(centre + radius * n);
      s.normals.push_back(n);
      s.colors.push_back({0.6f + 0.3f * n.x, 0.5f + 0.2f * n.y, 0.4f + 0.2f * n.z, 1});
    }
  const auto at = [columns](int i, int j) { return static_cast<std::uint32_t>(i * columns + j % columns); };
  for (int i = 0; i < rings; ++i)
    for (int j = 0; j < columns; ++j) {
      s.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      s.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return s;
}

inline Scene scene_of(std::initializer_list<const Solid*> solids) {
  Scene scene;
  for (const Solid* s : solids) scene.surfaces.push_back(s->surface());
  return scene;
}

}  // namespace mien::render_test
