#pragma once
#include <string>

namespace CLI {
class App;
}

namespace mien {

/// How a motion of vertices is shown and stored.
struct VertexOptions {
  std::string mesh;           ///< file with the triangles; empty: Mien's head where it has as many vertices
  double mm_per_unit = 0;     ///< 0: see length_scale()
  double max_error_mm = 0.1;  ///< of the blendshapes of a .glb
  bool inverted = false;      ///< the data's y points down and its z into the face
  std::string face;           ///< file of another face of the same topology, which then moves; or empty
  bool face_z_up = false;     ///< that file has z up and y into the face
};

/// --mesh, --mm-per-unit, --max-error and --inverted.
void add_vertex_options(CLI::App& command, VertexOptions& options);
/// --face and --face-z-up.
void add_other_face_options(CLI::App& command, VertexOptions& options);

}  // namespace mien
