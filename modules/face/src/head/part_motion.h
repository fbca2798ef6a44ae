#pragma once
#include <vector>

#include "head/parts.h"

namespace mien::head {

/// How parts other than the skin move: one list of offsets per ARKit name in its order, empty where the part
/// stays.
std::vector<Offsets> eyeball_shapes(const Part& eye, BodySide side);
std::vector<Offsets> teeth_shapes(const Part& teeth, Jaw jaw);
std::vector<Offsets> tongue_shapes(const Part& tongue);
/// Every vertex follows the six nearest skin vertices, the nearer the more.
std::vector<Offsets> follow_skin(const Part& part, const HeadSkin& skin,
                                 const std::vector<Offsets>& skin_shapes);

}  // namespace mien::head
