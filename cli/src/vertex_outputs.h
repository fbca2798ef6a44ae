#pragma once
#include <optional>
#include <string>
#include <vector>

#include "mien/console/console_progress.h"
#include "mien/core/audio_clip.h"
#include "mien/core/mesh.h"
#include "mien/core/motion.h"
#include "mien/face/vertex_sequence.h"
#include "outputs.h"
#include "pictures.h"
#include "vertex_options.h"

namespace mien {

/// The mesh that the options name, or Mien's head, or points (no triangles, with a warning).
/// Errors: those of load_mesh(); Errc::incompatible for a mesh with another number of vertices.
Result<Mesh> vertex_mesh(const VertexOptions& options, const Motion& motion);

/// The face that --face names, in the axes of the motion; nothing where none is named.
/// @param rest  what the motion moves away from. Errors: those of load_mesh(); Errc::incompatible for another
/// number of vertices; Errc::usage where the neutral face is not known: `rest` has no triangles.
Result<std::optional<Mesh>> other_face(const VertexOptions& options, const Mesh& rest);

/// A motion of vertices on that face, by carry_movement(); as it is where none is named.
Result<Motion> on_other_face(Motion motion, const Mesh& rest, const std::optional<Mesh>& face);

/// What else an output may need.
struct VertexShow {
  PictureOptions pictures;
  const AudioClip* sound = nullptr;  ///< of a video; may be null
  std::string audio_name;            ///< stored in a .glb
};

/// Motions of one mesh in metres on it, for pictures. Errors: Errc::usage for a mesh without triangles; those
/// of stage_vertices().
Result<std::vector<VertexStage>> staged(const Output& output, const std::vector<Motion>& motions,
                                        const Mesh& mesh, const VertexOptions& options);

/// Draws them side by side: write_pictures(). Errors: those of staged() and write_pictures().
Status write_vertex_pictures(const Output& output, const std::vector<Motion>& motions, const Mesh& mesh,
                             const VertexOptions& options, const AudioClip* sound,
                             const PictureOptions& pictures, Progress& progress);

/// Writes a motion of vertices: a film, pictures, a .glb of blendshapes in metres (the error that they leave
/// is stored in asset.extras and said on the terminal), numbered .obj or .vl frames, .npy or .json. Errors:
/// Errc::usage for pictures of a mesh without triangles; those of the writers.
Status write_vertex_output(const Output& output, const Motion& motion, const Mesh& mesh,
                           const VertexOptions& options, const VertexShow& show, ConsoleProgress& progress);

}  // namespace mien
