#pragma once
#include <string>

#include "mien/base/bytes.h"
#include "mien/base/result.h"
#include "mien/core/character.h"

namespace mien {

struct GltfWriteOptions {
  /// Give every target normal displacements: those of the shape, else computed from the moved surface.
  /// Without them the file is about 40 % smaller and lit as if the face did not move.
  bool normals = true;
  /// The point that the node "Head" turns about, e.g. neck_pivot(); metres. Vertices stay where they are.
  Vec3 pivot{0, 0, 0};
  /// A JSON object for asset.extras; empty: none.
  std::string extras = {};
};

/// A character as binary glTF 2.0, the same bytes for the same character.
///
/// A node "Head" (what an animation turns) carries one mesh "Face", whose primitives are the parts with
/// shapes, and one mesh per part without. All primitives of "Face" share the same targets: the names met in
/// any part, ARKit's first and in their order. Targets are sparse accessors. Names are in
/// mesh.extras.targetNames; each primitive's extras hold {part, order} and, for parts[0], {regions}. Colours
/// become normalised unsigned shorts, cut to [0, 1].
///
/// A part without triangles becomes points, without normals.
///
/// @pre Each part has vertices, arrays of matching sizes, finite numbers, and shapes whose vertex lists rise
/// strictly;
///      shape names are unique within a part; the extras are a JSON object (checked).
/// Errors: Errc::failed when the file would exceed the format's 4 GiB.
Result<Bytes> write_glb(const Character& character, const GltfWriteOptions& options = {});

}  // namespace mien
