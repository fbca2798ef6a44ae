#pragma once
#include <span>
#include <vector>

#include "mien/base/progress.h"
#include "mien/base/result.h"
#include "mien/transfer/deformation_transfer.h"
#include "mien/transfer/surface.h"

namespace mien {

/// A vertex of the source and the vertex of the target that is the same place of the face.
struct Marker {
  std::uint32_t source = 0, target = 0;
};

/// place = scale * rotation * point + offset
struct Similarity {
  double scale = 1;
  Matrix3 rotation = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  Point3 offset{};
  [[nodiscard]] Point3 operator()(const Point3& point) const;
};

/// The similarity (no reflection) that brings `from` closest to `to`, least squares (Umeyama 1991). Points on
/// one line or at one place leave the rotation about it open: any is taken. @pre as many of both, at least
/// one
Similarity best_similarity(std::span<const Point3> from, std::span<const Point3> to);

struct RegistrationOptions {
  /// Weights of the energy: difference of the deformation of triangles that share an edge, and of each from
  /// the identity (Sumner and Popovic 2004, section 4.1; SAiD specification, section 10.3).
  double smoothness = 1, identity = 0.001;
  /// Of the nearest points of the target, pass by pass, for squared distances in mean edges of the source.
  std::vector<double> closest = {1, 25, 45};
  /// Points of the target count up to this distance, in units of the target, and when the normals are less
  /// than 90 degrees apart.
  double reach = 0;
};

/// Errors (Errc::input): the first marker that names a vertex beyond those of its mesh, by its number and
/// side.
Status check_markers_exist(std::span<const Marker> markers, std::size_t num_source, std::size_t num_target);

/// The source bent onto the target: markers meet exactly, the rest is smooth and, where the target is within
/// reach, on it. Errors (Errc::input): markers that are not there or name a vertex twice; a source whose
/// triangles do not hold together. @return [V of the source]
Result<std::vector<Point3>> register_surface(const Surface& source, const Surface& target,
                                             std::span<const Marker> markers,
                                             const RegistrationOptions& options, Progress& progress);

/// Triangles of a registered source and of the target that lie on each other: the nearest centroid within
/// reach whose normal is within 90 degrees, from both sides (many to many), sorted by target and source.
std::vector<TrianglePair> pair_triangles(const Surface& registered, const Surface& target, double reach);

}  // namespace mien
