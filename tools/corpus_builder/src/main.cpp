// mien-corpus: makes synthetic speech with exact phone times, and from it training and test sets.
// docs/corpus.md.
#include <CLI/CLI.hpp>
#include <map>

#include "commands.h"

int main(int argc, char** argv) {
  CLI::App app(
      "Makes synthetic speech with exact phone times, and training and test sets of facial animation from "
      "it.");
  app.name("mien-corpus");
  app.require_subcommand(1);
  app.footer(
      "Exit codes: 0 done, 1 failed, 2 wrong usage, 3 input unreadable, 4 not a prepared set, 130 "
      "interrupted.");
  const std::map<std::string, mien::Command> commands = {{"list", mien::add_list_command(app)},
                                                         {"prepare", mien::add_prepare_command(app)},
                                                         {"check", mien::add_check_command(app)},
                                                         {"build", mien::add_build_command(app)}};
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  }
  return commands.at(app.get_subcommands().front()->get_name())();
}
