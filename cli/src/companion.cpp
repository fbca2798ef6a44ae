#include "companion.h"

#include <unistd.h>

#include <array>
#include <cerrno>
#include <system_error>
#include <vector>

#include "share.h"

namespace mien {
namespace {

constexpr std::array<Companion, 3> kCompanions = {{
    {"train", "mien-train", "MIEN_TRAIN", "Train a model from a prepared set (needs LibTorch)"},
    {"corpus", "mien-corpus", "MIEN_CORPUS_BUILDER",
     "Make synthetic speech and training sets (needs synthesisers)"},
    {"bench", "mien_bench", "MIEN_BENCH", "Measure the speed of the parts (needs Google Benchmark)"},
}};

}  // namespace

std::span<const Companion> companions() { return kCompanions; }

Error become(const Companion& companion, std::span<const std::string> arguments) {
  const auto path = program_folder() / companion.program;
  std::error_code ec;
  const std::string name = "mien " + std::string(companion.command);
  if (!std::filesystem::exists(path, ec))
    return {Errc::failed, name, "is not part of this build: " + path.string() + " is missing",
            "Configure with -D" + std::string(companion.option) + "=ON and build again"};
  std::vector<std::string> owned = {path.string()};
  owned.insert(owned.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (auto& argument : owned) argv.push_back(argument.data());
  argv.push_back(nullptr);
  ::execv(path.c_str(), argv.data());
  return {Errc::failed, name, path.string() + " cannot be started: " + std::generic_category().message(errno),
          ""};
}

}  // namespace mien
