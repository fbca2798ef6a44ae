#pragma once
#include <span>
#include <string>

#include "mien/core/blendshape_rig.h"
#include "mien/core/flame_model.h"
#include "mien/core/mesh.h"

namespace mien {

/// A model in FLAME's form on the topology of a face with ARKit shapes. Nothing of FLAME is in it; it is made
/// so that parameters and shapes can stand for each other nearly, as on a real FLAME with a rig:
///
/// - expression k is 0.3 times shape k and half of the next one, over all shapes but those of the jaw, the
///   gaze and the tongue; expressions beyond their number move nothing
/// - the jaw's joint and weights are those of a rotation by 0.3 about x that comes close to `jawOpen`
/// - the jaw's rotation about x adds a little of the first expression (a pose feature)
/// - shape 0 makes the face 2 % larger
///
/// @param num_expressions  at least as many as such shapes, or 0 for just these
/// @pre the shapes hold `jawOpen` and at least one other; the mesh is not flat
FlameModel made_flame(const Mesh& mesh, std::span<const Blendshape> shapes, std::size_t num_expressions = 0);

/// The model as a pickle that read_flame_model() reads.
std::string flame_pickle(const FlameModel& model);

}  // namespace mien
