#pragma once
#include <filesystem>
#include <string_view>

#include "mien/base/result.h"

namespace mien {

/// The folder that this program lies in.
std::filesystem::path program_folder();

/// A file that comes with Mien ("head.glb", "default.safetensors"): in the folder that the environment names
/// as MIEN_SHARE, else in ../share/mien beside the program, else where Mien was installed. Error
/// (Errc::input): nowhere; `option` is what the user can pass instead.
Result<std::filesystem::path> shared_file(std::string_view name, std::string_view option);

}  // namespace mien
