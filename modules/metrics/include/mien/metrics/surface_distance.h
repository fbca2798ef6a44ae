#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "mien/base/result.h"
#include "mien/core/mesh.h"
#include "mien/core/motion.h"

// FaceXHuBERT's "mean face vertex error": how far each predicted vertex lies from the true surface
// (specification, section 6). Unsigned; distances are computed in double.
namespace mien {

/// Triangles in a tree of boxes, for the closest point of a surface.
class TriangleTree {
 public:
  using Triangle = std::array<std::uint32_t, 3>;

  /// @pre at least one triangle, every index below the number of positions
  TriangleTree(std::span<const Vec3> positions, std::span<const Triangle> triangles);

  /// The same triangles elsewhere: the next frame. The tree keeps its shape, which costs speed when the
  /// surface has become another one, never correctness. @pre as many positions
  void move(std::span<const Vec3> positions);

  /// From a point to the nearest point of the nearest triangle; equal to brute force. Triangles without area
  /// count as their edges.
  [[nodiscard]] double distance(Vec3 point) const;

 private:
  struct Node {
    std::array<double, 3> low, high;
    std::uint32_t first =
        0;  // of its triangles; of an inner node: index of the second child, the first follows it
    std::uint32_t count = 0;  // 0: inner node
  };
  std::uint32_t build(std::uint32_t first, std::uint32_t count);
  void fit(std::uint32_t node);

  std::vector<Vec3> positions_;
  std::vector<Triangle> triangles_;  // in the order of the leaves
  std::vector<Node> nodes_;          // parents before their children
};

/// Distance from a point to one triangle.
double triangle_distance(Vec3 point, Vec3 a, Vec3 b, Vec3 c);

/// Mean over vertices, then over the common frames, of the distance from the predicted vertex to the true
/// surface. NaN without frames. The result is the same for any number of threads. Errors
/// (Errc::incompatible): not two motions of one topology, no triangles, or triangles that leave it.
Result<double> surface_distance(const Motion& truth, const Motion& predicted,
                                std::span<const TriangleTree::Triangle> triangles, int num_threads = 1);

}  // namespace mien
