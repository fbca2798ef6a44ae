#pragma once
#include <memory>
#include <span>
#include <vector>

#include "head/slit_grid.h"
#include "head/vec3d.h"

namespace mien::head {

/// Spreads offsets that are known at some vertices over the rest of a surface like a thin elastic plate:
/// least d^T (L A^-1 L + 0.06 L) d per coordinate, L the cotangent Laplacian and A the vertices' areas (spec
/// section 7).
class ThinPlate {
 public:
  ThinPlate(std::span<const Vec3d> positions, std::span<const Triangle> triangles);
  ~ThinPlate();

  /// Fills the unknown rows of every field; one factorisation for all of them. Safe from many threads.
  /// @param known   [V], the same for all fields
  /// @param fields  each [V]
  void spread(const std::vector<bool>& known, std::span<Offsets* const> fields) const;

 private:
  struct Energy;
  std::unique_ptr<Energy> energy_;
};

}  // namespace mien::head
