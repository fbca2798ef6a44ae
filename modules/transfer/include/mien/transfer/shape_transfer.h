#pragma once
#include <span>
#include <string>
#include <vector>

#include "mien/base/progress.h"
#include "mien/base/result.h"
#include "mien/core/blendshape_rig.h"
#include "mien/core/mesh.h"
#include "mien/transfer/registration.h"

namespace mien {

struct ShapeTransferOptions {
  RegistrationOptions registration;  ///< its `reach` 0: kReach of the markers' spread
  int num_threads = 1;               ///< the result is the same for any number
};
/// How far surfaces may lie apart to count as the same place, in root mean square distances of the target's
/// markers from their mean: about 8 mm on a face of natural size.
inline constexpr double kReach = 0.14;
/// Parts of the target that are farther than this many reaches from the registered source are held still.
inline constexpr double kHeldReaches = 5;
/// Over this length, in reaches, the target follows the gradients of the source; over longer ones its
/// offsets. A vertex has two triangles, so that an anchor of weight 2 / length^2 balances them there.
inline constexpr double kAnchorReaches = 1;

struct TransferredShape {
  std::string name;
  double source_mm = 0, target_mm = 0;  ///< farthest that a vertex goes, the source scaled to the target
  double misfit = 0;                    ///< root mean square difference of deformations over all equations
};

struct ShapeTransferReport {
  Similarity similarity;                          ///< source to target, from the markers
  std::vector<double> distance_mm;                ///< [V of the source] registered source to nearest target
  std::size_t num_paired = 0, num_triangles = 0;  ///< target triangles with a partner, and all
  std::size_t num_held = 0;                       ///< vertices
  std::size_t num_ties = 0;                       ///< vertices that move with another at the same place
  double registration_seconds = 0, factor_seconds = 0, solve_seconds = 0;
  std::vector<TransferredShape> shapes;
};

struct ShapeTransferResult {
  std::vector<Blendshape> shapes;  ///< in the target's vertex numbers; offsets below 0.01 % of a shape's
                                   ///< largest are left out
  ShapeTransferReport report;
};

/// One mesh of the two, and what takes no part.
struct TransferMesh {
  const Mesh* mesh = nullptr;       ///< metres
  std::vector<bool> excluded = {};  ///< [V] or empty: vertices to leave out, with their triangles
};

/// Makes the shapes of `source` for `target`, a mesh of any topology: registration with markers, triangle
/// pairs, deformation transfer. Excluded vertices of the target do not move. Pieces of the target that touch
/// stay together (touching_vertices()), as far as they take part.
///
/// Warnings: shapes that do not move the source, markers on excluded vertices (left out).
/// Errors (Errc::input): markers that are not there; fewer than four that count; those of register_surface()
/// and DeformationTransfer; Errc::incompatible when no triangles lie on each other; Errc::cancelled.
/// @pre shapes' vertices lie within the source; meshes' triangles within their vertices
Result<ShapeTransferResult> transfer_shapes(const TransferMesh& source, std::span<const Blendshape> shapes,
                                            const TransferMesh& target, std::span<const Marker> markers,
                                            const ShapeTransferOptions& options, Progress& progress);

}  // namespace mien
