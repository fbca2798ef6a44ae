#pragma once
#include <string>
#include <vector>

#include "head/handles.h"
#include "head/parts.h"

namespace mien::head {

/// A part with the offsets of the shapes that move it.
struct MovingPart {
  std::string name;  ///< "skin", "eyeLeft", "teethLower" ...
  Part mesh;
  std::vector<Offsets>
      shapes;  ///< one per ARKit name in its order; an empty list where the part does not move
};

/// The whole head in double precision, cm, before the final scaling.
struct HeadModel {
  HeadSkin skin;
  Handles handles;
  std::vector<MovingPart> parts;  ///< the skin first
};

HeadModel build_head_model(int num_threads, const HeadDesign& design = {});

}  // namespace mien::head
