#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace mien {

/// 3DMEAD in its true form, small: half a second of sound and of parameters [1, 12, 403] for each name, in
/// wav and param. Each has motion of its own.
void write_mead_parameters(const std::filesystem::path& folder, const std::vector<std::string>& names);
/// The same as meshes of four vertices in vertices_npy, with templates.
void write_mead_meshes(const std::filesystem::path& folder, const std::vector<std::string>& names);

}  // namespace mien
