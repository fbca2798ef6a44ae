#pragma once
#include <filesystem>

#include "mien/base/result.h"
#include "mien/core/character.h"

namespace mien::io {

/// A folder of meshes of one topology as a character: neutral.obj (any case, .obj or .ply) and one mesh per
/// shape, named after it. Positions are taken for metres.
Result<Character> read_blendshape_folder(const std::filesystem::path& folder);

}  // namespace mien::io
