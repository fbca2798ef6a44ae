#pragma once
#include <filesystem>
#include <string>

#include "mien/base/bytes.h"
#include "mien/base/result.h"

namespace mien {

/// The file of the character: the one that the user named, else the default head.
Result<std::filesystem::path> character_path(const std::string& named);

/// The character as glTF that animate_glb() takes: the bytes of a glTF file, or of one made from a character
/// in another format. It is tried with one frame of the default model's channels, so that a file of the wrong
/// kind is an error before the work, not after it. Errors: those of load_character() and animate_glb().
Result<Bytes> character_glb(const std::filesystem::path& path);

}  // namespace mien
