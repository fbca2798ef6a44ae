#pragma once
#include <filesystem>
#include <string_view>

namespace mien {

/// Recordings, faces and fixtures beside the project: MIEN_SHARED, else ../shared. A test that needs an
/// absent file is skipped by name.
[[nodiscard]] std::filesystem::path shared_path(std::string_view name);

/// A file of the project: "tests/data/golden", "share/default.safetensors".
[[nodiscard]] std::filesystem::path project_path(std::string_view name);

/// What the build made beside the running test: "bin/mien", "share/mien/head.glb". No path of the build is
/// compiled in, so that a compiler cache gives a test's objects to every clone and preset.
[[nodiscard]] std::filesystem::path built_path(std::string_view name);

}  // namespace mien
