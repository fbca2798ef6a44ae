#include "share.h"

#include <cstdlib>
#include <vector>

namespace mien {

namespace fs = std::filesystem;

fs::path program_folder() {
  std::error_code ec;
  return fs::read_symlink("/proc/self/exe", ec).parent_path();
}

Result<fs::path> shared_file(std::string_view name, std::string_view option) {
  std::vector<fs::path> folders;
  if (const char* named = std::getenv("MIEN_SHARE"); named != nullptr && *named != 0) {
    folders.emplace_back(named);
  } else {
    folders.push_back(program_folder().parent_path() / "share" / "mien");
    folders.emplace_back(MIEN_INSTALL_SHARE);
  }
  std::string looked;
  for (const auto& folder : folders) {
    std::error_code ec;
    if (fs::exists(folder / name, ec)) return folder / name;
    looked += (looked.empty() ? "" : " and ") + folder.string();
  }
  return Error{Errc::input, "'" + std::string(name) + "'", "not found in " + looked,
               "Pass " + std::string(option) + " or set MIEN_SHARE to the folder that holds it"};
}

}  // namespace mien
