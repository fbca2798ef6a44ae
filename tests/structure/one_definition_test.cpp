#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "test_paths.h"

namespace mien {
namespace {

namespace fs = std::filesystem;

// Types that a source file defines at the beginning of a line, with their namespaces; those of unnamed
// namespaces are its own and left out.
std::vector<std::string> types_of(std::istream& source) {
  static const std::regex opening(R"(^(?:inline )?namespace ?([\w:]*) ?\{.*)");
  static const std::regex closing(R"(^\}  // namespace.*)");
  static const std::regex type(R"(^(?:struct|class|enum class) (\w+)(?: final)?(?: :[^:].*)? ?\{.*)");
  std::vector<std::string> namespaces, types;
  std::smatch found;
  for (std::string line; std::getline(source, line);) {
    if (std::regex_match(line, found, opening)) {
      namespaces.push_back(found[1]);
    } else if (std::regex_match(line, closing) && !namespaces.empty()) {
      namespaces.pop_back();
    } else if (std::regex_match(line, found, type)) {
      std::string name;
      bool is_own = false;
      for (const auto& space : namespaces) {
        is_own = is_own || space.empty();
        name += space + "::";
      }
      if (!is_own) types.push_back(name + found[1].str());
    }
  }
  return types;
}

// Two types of one name in one program share the functions that the compiler makes for them, such as those of
// a vector, and the linker keeps those of one.
TEST(OneDefinition, NoTwoTypesOfANamespaceShareAName) {
  std::map<std::string, std::set<std::string>> files;
  for (const char* folder : {"modules", "cli", "tools"})
    for (const auto& entry : fs::recursive_directory_iterator(project_path(folder))) {
      const fs::path& path = entry.path();
      const bool is_test = path.string().find("/test/") != std::string::npos;
      if (is_test || (path.extension() != ".h" && path.extension() != ".cpp")) continue;
      std::ifstream source(path);
      for (const auto& type : types_of(source))
        files[type].insert(fs::relative(path, project_path(".")).string());
    }
  EXPECT_GT(files.size(), 200u) << "the search no longer understands the sources";
  for (const auto& [type, where] : files)
    EXPECT_EQ(where.size(), 1u) << type << " is defined in " << testing::PrintToString(where);
}

}  // namespace
}  // namespace mien
