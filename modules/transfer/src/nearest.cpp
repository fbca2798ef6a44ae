#include "nearest.h"

#include <algorithm>
#include <functional>
#include <numeric>

namespace mien {

NearestPoint::NearestPoint(std::span<const Point3> points) : points_(points.begin(), points.end()) {
  order_.resize(points_.size());
  std::iota(order_.begin(), order_.end(), 0u);
  const std::function<void(std::size_t, std::size_t, std::size_t)> split =
      [&](std::size_t first, std::size_t end, std::size_t axis) {
        if (end - first < 2) return;
        const std::size_t middle = first + (end - first) / 2;
        std::nth_element(order_.begin() + static_cast<std::ptrdiff_t>(first),
                         order_.begin() + static_cast<std::ptrdiff_t>(middle),
                         order_.begin() + static_cast<std::ptrdiff_t>(end),
                         [&](std::uint32_t a, std::uint32_t b) {
                           const double pa = points_[a][axis], pb = points_[b][axis];
                           return pa != pb ? pa < pb : a < b;
                         });
        split(first, middle, (axis + 1) % 3);
        split(middle + 1, end, (axis + 1) % 3);
      };
  split(0, order_.size(), 0);
}

}  // namespace mien
