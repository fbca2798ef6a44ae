#pragma once
#include "mien/core/character.h"
#include "shapes.h"

namespace mien::render_test {

/// A ball whose lower half is its "jaw": jawOpen moves it down and forward.
inline Character ball_character() {
  Character character;
  Solid solid = ball({0.3f, -2, 0.1f}, 0.1f, 20);
  Blendshape jaw{"jawOpen", {}, {}, {}};
  for (std::uint32_t v = 0; v < solid.positions.size(); ++v)
    if (solid.normals[v].y < -0.3f) {
      jaw.vertices.push_back(v);
      jaw.offsets.push_back({0, -0.02f, 0.03f});
    }
  character.name = "ball";
  character.parts.push_back({"skin", {solid.positions, solid.triangles, solid.normals, solid.colors}, {jaw}});
  return character;
}

}  // namespace mien::render_test
