#pragma once
#include <map>
#include <string>

#include "head/shape_target.h"

namespace mien::head {

/// Prescriptions by shape name: one-sided shapes for the left only, eye and tongue shapes that leave the skin
/// alone missing.
using ShapeTargets = std::map<std::string, ShapeTarget>;

void add_jaw_targets(const ShapeBase& base, ShapeTargets& targets);
void add_corner_targets(const ShapeBase& base, ShapeTargets& targets);
void add_lip_targets(const ShapeBase& base, ShapeTargets& targets);
void add_upper_face_targets(const ShapeBase& base, ShapeTargets& targets);

/// Offsets of the skin for the 52 ARKit names in their order, cm. Exactly symmetric.
std::vector<Offsets> build_skin_shapes(const ShapeBase& base, int num_threads);

}  // namespace mien::head
