#include "test_paths.h"

#include <cstdlib>

namespace mien {

std::filesystem::path shared_path(std::string_view name) {
  const char* root = std::getenv("MIEN_SHARED");
  return (root != nullptr ? std::filesystem::path(root) : project_path("../shared")) / name;
}

std::filesystem::path project_path(std::string_view name) {
  return std::filesystem::path(MIEN_PROJECT_DIR) / name;
}

std::filesystem::path built_path(std::string_view name) {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path().parent_path() / name;
}

}  // namespace mien
