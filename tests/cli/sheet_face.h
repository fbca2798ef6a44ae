#pragma once
#include <cmath>
#include <initializer_list>
#include <string>
#include <utility>

#include "mien/core/character.h"

namespace mien {

/// A sheet of 0.2 m that bulges in the middle, raised by `jaw` below its middle, by `smile` at its left and
/// by `brow` above its middle.
inline Mesh sheet_mesh(int columns, int rows, double jaw = 0, double smile = 0, double brow = 0) {
  Mesh mesh;
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      const double x = 2.0 * i / (columns - 1) - 1, y = 2.0 * j / (rows - 1) - 1;
      const double z = 0.6 * std::exp(-3 * (x * x + y * y)) +
                       jaw * std::exp(-4 * (x * x + (y + 0.5) * (y + 0.5))) +
                       smile * std::exp(-4 * ((x - 0.5) * (x - 0.5) + y * y)) +
                       brow * std::exp(-4 * (x * x + (y - 0.5) * (y - 0.5)));
      mesh.positions.push_back(
          {static_cast<float>(0.1 * x), static_cast<float>(0.1 * y), static_cast<float>(0.1 * z)});
      if (i + 1 == columns || j + 1 == rows) continue;
      const auto v = static_cast<std::uint32_t>(j * columns + i), c = static_cast<std::uint32_t>(columns);
      mesh.triangles.push_back({v, v + 1, v + c});
      mesh.triangles.push_back({v + 1, v + c + 1, v + c});
    }
  return mesh;
}

/// The sheet with the shapes jawOpen, mouthSmileLeft, browInnerUp, and eyeLookUpLeft, which moves what
/// browInnerUp does.
inline Character sheet_face(int columns, int rows) {
  Character face{"sheet", {{"skin", sheet_mesh(columns, rows), {}}}, {}};
  CharacterPart& skin = face.parts.front();
  const auto add = [&](const char* name, const Mesh& moved) {
    Blendshape shape{name, {}, {}, {}};
    for (std::uint32_t v = 0; v < moved.positions.size(); ++v) {
      shape.vertices.push_back(v);
      shape.offsets.push_back(moved.positions[v] - skin.mesh.positions[v]);
    }
    skin.shapes.push_back(std::move(shape));
  };
  add("jawOpen", sheet_mesh(columns, rows, 0.3));
  add("mouthSmileLeft", sheet_mesh(columns, rows, 0, 0.3));
  add("browInnerUp", sheet_mesh(columns, rows, 0, 0, 0.2));
  add("eyeLookUpLeft", sheet_mesh(columns, rows, 0, 0, 0.1));
  return face;
}

}  // namespace mien
