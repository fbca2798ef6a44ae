#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "mien/core/vector.h"

namespace mien {

/// One shape of a rig, sparse: what to add to the listed vertices at coefficient 1.
struct Blendshape {
  std::string name;
  std::vector<std::uint32_t> vertices;  // [M] strictly increasing
  std::vector<Vec3> offsets;            // [M] metres
  std::vector<Vec3> normal_offsets;     // [M] or empty
};

/// out[v] = neutral[v] + sum over k of coefficients[k] * shapes[k] at v. Linear and unclamped: coefficients outside
/// [0, 1] extrapolate.
///
/// @param neutral       [V] metres
/// @param shapes        [K] every vertex index below V
/// @param coefficients  [K] unitless
/// @param out           [V] metres; may not overlap neutral
/// @pre   Shapes agree (checked). Allocates nothing; safe from many threads.
void evaluate_blendshapes(std::span<const Vec3> neutral, std::span<const Blendshape> shapes,
                          std::span<const float> coefficients, std::span<Vec3> out);

}  // namespace mien
