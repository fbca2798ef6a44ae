#pragma once
#include "head/slit_grid.h"

namespace mien::head {

inline constexpr double kBrowStartX = 1.02, kBrowLength = 3.75;  ///< cm, of the left brow

/// Middle line of the left brow at u in 0 (beside the nose) ... 1 (temple), seen from the front.
FrontPosition brow_curve(double u);

}  // namespace mien::head
