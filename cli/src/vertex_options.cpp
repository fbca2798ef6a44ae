#include "vertex_options.h"

#include <CLI/CLI.hpp>

namespace mien {

void add_vertex_options(CLI::App& command, VertexOptions& options) {
  command.add_option("--mesh", options.mesh,
                     "Triangles of a motion of vertices: the data set's template (.obj .ply) or a character");
  command
      .add_option(
          "--mm-per-unit", options.mm_per_unit,
          "Length of a unit of a motion of vertices. Default: known for VOCASET; else the mesh's largest "
          "extent counts as 240 mm")
      ->check(CLI::PositiveNumber);
  command
      .add_option("--max-error", options.max_error_mm,
                  "Farthest in mm that a vertex of a .glb may lie from its place, 0.0001 to 100")
      ->check(CLI::Range(1e-4, 100.0))
      ->capture_default_str();
  command.add_flag("--inverted", options.inverted,
                   "A motion of vertices has y down and z into the face (BIWI as recorded, FaceXHuBERT)");
}

void add_other_face_options(CLI::App& command, VertexOptions& options) {
  auto* face = command.add_option(
      "--face", options.face,
      "Another face of the same topology (.obj .ply or a character), in the units of the motion, which moves "
      "as the motion does away from its neutral face: the FLAME model's, or that of --mesh");
  command
      .add_flag("--face-z-up", options.face_z_up,
                "The file of --face has z up and y into the face, as modelling programs write it")
      ->needs(face);
}

}  // namespace mien
