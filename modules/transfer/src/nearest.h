#pragma once
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "mien/transfer/surface.h"

namespace mien {

/// A k-d tree: the nearest of many points among those that a test accepts. Of equally near ones the one with
/// the smallest number.
class NearestPoint {
 public:
  static constexpr std::uint32_t kNone = ~0u;

  explicit NearestPoint(std::span<const Point3> points);

  /// kNone when no accepted point is nearer than `reach`.
  template <class Accepts>
  [[nodiscard]] std::uint32_t find(const Point3& place, double reach, Accepts&& accepts) const {
    Best best{kNone, reach * reach};
    search(place, 0, order_.size(), 0, best, accepts);
    return best.index;
  }

 private:
  struct Best {
    std::uint32_t index;
    double square;
  };

  template <class Accepts>
  void search(const Point3& place, std::size_t first, std::size_t end, int axis, Best& best,
              Accepts& accepts) const {
    if (first >= end) return;
    const std::size_t middle = first + (end - first) / 2;
    const std::uint32_t index = order_[middle];
    const Point3& point = points_[index];
    double square = 0;
    for (std::size_t i = 0; i < 3; ++i) square += (point[i] - place[i]) * (point[i] - place[i]);
    if ((square < best.square || (square == best.square && index < best.index)) && accepts(index))
      best = {index, square};
    const double beyond = place[static_cast<std::size_t>(axis)] - point[static_cast<std::size_t>(axis)];
    const int next = (axis + 1) % 3;
    const bool low_first = beyond < 0;
    for (const bool low : {low_first, !low_first}) {
      if (low != low_first && beyond * beyond > best.square) continue;
      if (low)
        search(place, first, middle, next, best, accepts);
      else
        search(place, middle + 1, end, next, best, accepts);
    }
  }

  std::vector<Point3> points_;
  std::vector<std::uint32_t> order_;  // of each range the middle one splits the rest
};

}  // namespace mien
