#pragma once
#include <vector>

#include "head/parts.h"

namespace mien::head {

/// The upper lashes of one eye: a dark strip along the lid edge that ends in points, and how each vertex
/// follows the skin.
struct Lashes {
  struct Follow {
    std::uint32_t from, to;  ///< skin vertices of the lid edge
    double share;            ///< 0 follows `from`, 1 `to`
    double droop;            ///< additional share of the lid's vertical motion: lashes tilt as the lid turns
  };
  Part mesh;
  std::vector<Follow> follow;  // [V]
};

/// @param eye  index into HeadSkin::eyes
Lashes build_lashes(const HeadSkin& skin, std::size_t eye);

/// One list of offsets per ARKit name in its order.
std::vector<Offsets> lash_shapes(const Lashes& lashes, const std::vector<Offsets>& skin_shapes);

}  // namespace mien::head
