#pragma once
#include <memory>
#include <span>
#include <vector>

#include "mien/base/result.h"
#include "mien/transfer/surface.h"

namespace mien {

/// Row-major.
using Matrix3 = std::array<Point3, 3>;

/// A source triangle and a target triangle that shall deform alike.
struct TrianglePair {
  std::uint32_t source = 0, target = 0;
  friend auto operator<=>(const TrianglePair&, const TrianglePair&) = default;
};

/// [F] S = [e1' e2' n'] [e1 e2 n]^-1 with edges from the first corner and unit normals: how each triangle of
/// `rest` is deformed. The identity for triangles without area.
/// @param deformed  [V] positions of the same vertices @pre sizes agree
std::vector<Matrix3> deformation_gradients(const Surface& rest, std::span<const Point3> deformed);

/// A vertex that shall come near a place that differs from shape to shape.
struct Anchor {
  std::uint32_t vertex = 0;
  double weight = 0;  ///< of its squared distance; >= 0, one over a squared length
};

/// Deformation transfer (Sumner and Popovic 2004, section 3; SAiD specification, section 10.3): the target
/// whose triangles deform like those of the source that they are paired with, by least squares
///
///   sum over pairs (s, t) of || V'_t W_t^+ - S_s W_t W_t^+ ||^2,   W = [e1 e2] of the target at rest
///
/// with S = identity for target triangles without a partner. The matrix depends on the target alone: it is
/// factored once, for all shapes. Gradients say nothing of where a surface is, and little of where its far
/// end is: anchors, which the publication does not have, add  weight * || v' - place ||^2  for that. Ties
/// hold together what touches but has no edge in common:  stiffness * || (a' - a) - (b' - b) ||^2.
class DeformationTransfer {
 public:
  /// @param held  vertices that stay where they are. Of every component (connected by edges and ties) without
  ///              one and without an anchor the first vertex is held: its shapes are then known but for a
  ///              translation.
  /// @param ties  vertices that move together
  /// Triangles without area say nothing, and vertices of no other triangle are held.
  /// Errors (Errc::input): the system cannot be factored.
  /// @pre indices of pairs, held vertices, anchors and ties exist
  static Result<DeformationTransfer> create(Surface target, std::vector<TrianglePair> pairs,
                                            std::span<const std::uint32_t> held,
                                            std::vector<Anchor> anchors = {}, std::vector<Tie> ties = {});
  DeformationTransfer(DeformationTransfer&&) noexcept;
  DeformationTransfer& operator=(DeformationTransfer&&) noexcept;
  ~DeformationTransfer();

  struct Shape {
    std::vector<Point3> points;  // [V]
    double energy = 0;           ///< the sum over pairs, without anchors and ties
  };
  /// Safe from many threads.
  /// @param gradients  of the source's triangles @pre as many as the pairs name
  /// @param places     one per anchor @pre sizes agree
  [[nodiscard]] Shape transfer(std::span<const Matrix3> gradients, std::span<const Point3> places = {}) const;

 private:
  struct State;
  explicit DeformationTransfer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace mien
