#pragma once
#include <span>
#include <string>

#include "mien/base/result.h"
#include "mien/core/character.h"
#include "mien/core/motion.h"
#include "mien/face/pose.h"

// Sequences of vertex positions: made from coefficients, and shown on triangles that come from elsewhere.
namespace mien {

/// Positions of all vertices of all parts, in their order, in every frame of a motion of named coefficients:
/// the blendshape rig applied. Its topology is that of merged_mesh(), named after the character. Errors
/// (Errc::incompatible): the motion is not made of coefficients, or moves nothing of the character.
Result<Motion> vertex_sequence(const Character& character, const Motion& motion, int num_threads = 1);

/// The parts of a character at the positions of one frame, with normals.
/// @param frame  [3 V] of a motion whose V is the number of vertices of all parts @pre sizes agree
void pose_vertices(const Character& character, std::span<const float> frame, PosedCharacter& out);

/// How long a unit of a motion of vertices is.
struct LengthScale {
  double mm_per_unit = 1;
  std::string reason;  ///< for people: "the data set is in metres"
};
/// Scaled data sets (BIWI, Multiface) have lost their millimetres. Then the largest extent of the first frame
/// counts as kHeadExtentMm, about the height of a head: a convention, not a measurement.
inline constexpr double kHeadExtentMm = 240;
/// @param mm_per_unit  what the user says, or 0: known from the topology, else the convention
/// @pre space `vertices`
LengthScale length_scale(const Motion& motion, double mm_per_unit = 0);

/// Which way the data looks. Mien draws +y up and +z out of the face.
enum class DataAxes {
  upright,   ///< as drawn
  inverted,  ///< y down, z into the face: BIWI as recorded, FaceXHuBERT; turned by half a circle about x
};

/// What is needed to draw a motion of vertices with the tools for characters: one part "skin" at the first
/// frame, and the motion, both in metres and upright.
struct VertexStage {
  Character character;
  Motion motion;
};
/// @param mesh  gives the triangles (none: points), and colours if it has them; its positions are not used
/// Errors: Errc::incompatible when the mesh has another number of vertices than the motion; Errc::input for a
/// motion without frames.
Result<VertexStage> stage_vertices(const Motion& motion, const Mesh& mesh, const LengthScale& scale,
                                   DataAxes axes);

}  // namespace mien
