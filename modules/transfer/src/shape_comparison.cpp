#include "mien/transfer/shape_comparison.h"

#include <algorithm>
#include <cmath>

namespace mien {
namespace {

std::vector<Vec3> dense(const Blendshape& shape, const std::vector<bool>& excluded) {
  std::vector<Vec3> offsets(excluded.size());
  for (std::size_t m = 0; m < shape.vertices.size(); ++m)
    if (!excluded[shape.vertices[m]]) offsets[shape.vertices[m]] = shape.offsets[m];
  return offsets;
}

ShapeComparison compare(const Blendshape& shape, const Blendshape& other, const std::vector<bool>& excluded) {
  const auto ours = dense(shape, excluded), theirs = dense(other, excluded);
  ShapeComparison result{shape.name};
  double product = 0, our_square = 0, their_square = 0, sum = 0, count = 0;
  for (std::size_t v = 0; v < excluded.size(); ++v) {
    if (excluded[v]) continue;
    const double apart = 1000.0 * length(ours[v] - theirs[v]);
    sum += apart;
    count += 1;
    result.max_mm = std::max(result.max_mm, apart);
    result.largest_mm = std::max(result.largest_mm, 1000.0 * length(theirs[v]));
    product += static_cast<double>(dot(ours[v], theirs[v]));
    our_square += static_cast<double>(dot(ours[v], ours[v]));
    their_square += static_cast<double>(dot(theirs[v], theirs[v]));
  }
  if (count > 0) result.mean_mm = sum / count;
  if (our_square > 0 && their_square > 0) result.cosine = product / std::sqrt(our_square * their_square);
  return result;
}

}  // namespace

std::vector<ShapeComparison> compare_shapes(std::span<const Blendshape> shapes,
                                            std::span<const Blendshape> others,
                                            const std::vector<bool>& excluded) {
  std::vector<ShapeComparison> comparisons;
  for (const Blendshape& shape : shapes) {
    const auto other =
        std::find_if(others.begin(), others.end(), [&](const Blendshape& o) { return o.name == shape.name; });
    if (other != others.end()) comparisons.push_back(compare(shape, *other, excluded));
  }
  return comparisons;
}

}  // namespace mien
