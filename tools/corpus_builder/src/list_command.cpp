#include <CLI/CLI.hpp>
#include <cstdio>

#include "commands.h"
#include "plan.h"

namespace mien {
namespace {

void print(const char* title, const std::vector<std::string>& names) {
  std::printf("%s:", title);
  for (const auto& name : names) std::printf(" %s", name.c_str());
  std::printf("\n");
}

int list() {
  std::vector<std::string> missing;
  for (const auto* engine : available_engines(&missing))
    print((std::string(engine_name(engine->id())) + " (" + engine->version() + ")").c_str(),
          engine->voices());
  for (const auto& line : missing) std::printf("absent: %s\n", line.c_str());
  print("espeak variants for training", training_variants());
  print("espeak variants for tests only", held_out_variants());
  return 0;
}

}  // namespace

Command add_list_command(CLI::App& app) {
  auto* c = app.add_subcommand(
      "list", "Print the engines, voices and variants that are present, and what is absent.");
  c->footer("Example:\n  mien-corpus list");
  return [] { return list(); };
}

}  // namespace mien
