#pragma once
#include <span>

#include "mien/base/result.h"
#include "mien/core/mesh.h"
#include "mien/core/motion.h"

namespace mien {

/// The movement of one face on another of the same topology: face + (frame - neutral), vertex by vertex, as
/// ProbTalk3D's authors show their motions on other heads (specification, section 14). Computed in double.
/// @param vertices  space `vertices`, in the unit of both faces;  neutral  [3 V] what it moves away from
/// Errors (Errc::incompatible): a motion of another space, faces with another number of vertices.
Result<Motion> carry_movement(Motion vertices, std::span<const float> neutral, const Mesh& face);

/// A mesh that was written with z up and y into the face, as modelling programs do, as it is drawn here, with
/// y up: (x, y, z) becomes (x, z, -y). Normals, if it has any, too.
void turn_z_up(Mesh& mesh);

}  // namespace mien
