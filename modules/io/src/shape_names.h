#pragma once
#include <optional>
#include <string>
#include <vector>

#include "gltf_document.h"

namespace mien::io {

/// Morph targets of a mesh (of its first primitive; all must have the same).
std::size_t num_targets(const Json& mesh);

/// Names of a mesh's morph targets: mesh.extras.targetNames, else the first primitive's extras.targetNames,
/// else the names of the targets' accessors; "target_<n>" where there is none. As many as num_targets().
std::vector<std::string> target_names(const GltfDocument& document, const Json& mesh);

/// ARKit name of each shape, or nothing where it has none. Two shapes stand for one name only when they are
/// the left and right half of a symmetric shape (browInnerUp_L, browInnerUp_R); of other doubles the plainest
/// spelling wins.
std::vector<std::optional<std::string>> arkit_of(const std::vector<std::string>& names);

/// Comma separated, at most `limit` of them, then "and N more".
std::string listed(const std::vector<std::string>& names, std::size_t limit = 12);

}  // namespace mien::io
