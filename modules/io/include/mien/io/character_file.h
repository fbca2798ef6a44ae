#pragma once
#include <filesystem>

#include "mien/base/result.h"
#include "mien/core/character.h"

namespace mien {

/// A character from a file, chosen by its extension, or from a folder:
/// - .glb, .gltf, .vrm: glTF, see read_glb();
/// - .safetensors: one part "skin" from the tensors `neutral` F32 [V, 3] and `triangles` I32 [F, 3], shapes
/// from
///   `shape.<name>` F32 [V, 3], regions from `landmarks68` and `region.<name>` I32. Metadata `units` says
///   metres (assumed when absent), centimetres or millimetres; `name` names the character.
/// - a folder: neutral.obj (or .ply, any case) and one mesh of the same vertices per shape, in metres, as
///   SAiD publishes ARKit's shapes (its specification, section 10.1).
///
/// Warnings: as read_glb(); tensors that have no use here.
/// Errors: Errc::input for missing and damaged files, Errc::incompatible for files of another kind.
Result<Character> load_character(const std::filesystem::path& path);

}  // namespace mien
