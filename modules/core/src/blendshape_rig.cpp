#include "mien/core/blendshape_rig.h"

#include <algorithm>

#include "mien/base/contract.h"

namespace mien {

void evaluate_blendshapes(std::span<const Vec3> neutral, std::span<const Blendshape> shapes,
                          std::span<const float> coefficients, std::span<Vec3> out) {
  contract(out.size() == neutral.size(), "evaluate_blendshapes: out and neutral differ in size");
  contract(shapes.size() == coefficients.size(), "evaluate_blendshapes: one coefficient per shape expected");
  std::copy(neutral.begin(), neutral.end(), out.begin());
  for (std::size_t k = 0; k < shapes.size(); ++k) {
    const float w = coefficients[k];
    if (w == 0.0f) continue;
    const Blendshape& shape = shapes[k];
    for (std::size_t i = 0; i < shape.vertices.size(); ++i) out[shape.vertices[i]] += w * shape.offsets[i];
  }
}

}  // namespace mien
