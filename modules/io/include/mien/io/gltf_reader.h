#pragma once
#include <filesystem>
#include <span>

#include "mien/base/bytes.h"
#include "mien/base/result.h"
#include "mien/core/character.h"

namespace mien {

/// A character from a glTF 2.0 file: .glb, or .gltf with embedded data.
///
/// Every triangle primitive of the default scene becomes a part, in one common space (node transforms and the
/// rest pose of skins applied). Morph targets become shapes under their ARKit name (match_arkit_name); other
/// targets keep the name of the file, and their default weight is baked into the neutral. Shapes that move
/// nothing in a part are left out of it. The part that the ARKit shapes move most comes first, unless the
/// file says otherwise.
///
/// Warnings: ARKit names that the file lacks, targets without an ARKit name, primitives that are not
/// triangles. Errors: Errc::input for damaged files; Errc::incompatible for compressed geometry (Draco,
/// meshopt) and for files without any triangles.
Result<Character> read_glb(std::span<const std::byte> bytes);
/// The same; buffers of a .gltf may also be files in its folder.
Result<Character> read_glb(const std::filesystem::path& path);

}  // namespace mien
