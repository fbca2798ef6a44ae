// mien: speech to 3D facial animation. The sub-commands are one file each.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <optional>

#include "command.h"
#include "companion.h"
#include "data_command.h"
#include "mien/console/console_exit.h"
#include "nearest_name.h"

namespace mien {
namespace {

std::vector<std::string> command_names(const CLI::App& program) {
  std::vector<std::string> names;
  for (const auto* command : program.get_subcommands({})) names.push_back(command->get_name());
  for (const auto& companion : companions()) names.emplace_back(companion.command);
  names.emplace_back("help");
  return names;
}

CLI::App* find_command(CLI::App& app, const std::string& name) {
  for (auto* command : app.get_subcommands({}))
    if (command->get_name() == name) return command;
  return nullptr;
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const auto& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

Error unknown_command(const CLI::App& program, const std::string& word) {
  const auto names = command_names(program);
  const auto near = nearest_name(word, names);
  return {Errc::usage, "command '" + word + "'", "is not known",
          (near.empty() ? "" : "Did you mean 'mien " + near + "'? ") + "Known: " + joined(names)};
}

// The words of the command line that look like options which the sub-command does not have.
std::optional<Error> unknown_option(const CLI::App& command, const std::vector<std::string>& words) {
  std::vector<std::string> known;
  for (const auto* option : command.get_options()) {
    for (const auto& name : option->get_lnames()) known.push_back("--" + name);
  }
  for (const auto& word : words) {
    if (word == "--") break;
    const std::string name = word.substr(0, word.find('='));
    if (!name.starts_with("--") || std::find(known.begin(), known.end(), name) != known.end()) continue;
    const auto near = nearest_name(name, known);
    return Error{Errc::usage, "option '" + name + "'", "is not known",
                 (near.empty() ? "" : "Did you mean " + near + "? ") + "Known: " + joined(known)};
  }
  return std::nullopt;
}

// Full names of nested commands that were given: "mien evaluate human".
std::pair<const CLI::App*, std::string> deepest(const CLI::App& program) {
  const CLI::App* app = &program;
  std::string name = "mien";
  for (auto given = app->get_subcommands(); !given.empty(); given = app->get_subcommands()) {
    app = given.front();
    name += " " + app->get_name();
  }
  return {app, name};
}

Error usage_error(const CLI::App& program, const CLI::ParseError& error,
                  const std::vector<std::string>& words) {
  const auto [command, name] = deepest(program);
  if (auto unknown = unknown_option(*command, words)) return *std::move(unknown);
  std::string why = error.what();
  if (const auto extra = command->remaining(); !extra.empty())
    why = "does not expect '" + extra.front() + "'";
  return {Errc::usage, name, why, "See: " + name + " --help"};
}

int print_help(CLI::App& program, const std::vector<std::string>& words, ConsoleProgress& progress) {
  if (words.empty()) return std::fputs(program.help().c_str(), stdout), 0;
  for (const auto& companion : companions())
    if (words.front() == companion.command)
      return report_error(become(companion, std::vector<std::string>{"--help"}), progress);
  CLI::App* app = &program;
  std::string before;  // names of the commands around it
  for (const auto& word : words) {
    before += (before.empty() ? "" : " ") + app->get_name();
    app = find_command(*app, word);
    if (app == nullptr) return report_error(unknown_command(program, word), progress);
  }
  std::fputs(app->help(before).c_str(), stdout);
  return 0;
}

int run(const std::vector<std::string>& words) {
  const auto has = [&](std::string_view flag) {
    return std::find(words.begin(), words.end(), flag) != words.end();
  };
  ConsoleProgress progress(has("--json")    ? ConsoleMode::json
                           : has("--quiet") ? ConsoleMode::quiet
                                            : ConsoleMode::text);
  cancel_on_interrupt(progress);
  Chosen chosen;
  CLI::App program("Mien turns recorded speech into 3D facial animation.", "mien");
  program.set_version_flag("--version", "mien " MIEN_VERSION);
  add_animate_command(program, chosen);
  add_edit_command(program, chosen);
  add_render_command(program, chosen);
  add_inspect_command(program, chosen);
  add_import_command(program, chosen);
  add_evaluate_command(program, chosen);
  add_fit_command(program, chosen);
  add_transfer_command(program, chosen);
  add_data_command(program, chosen);
  std::string footer = "Programs of their own, when they were built:\n";
  for (const auto& companion : companions())
    footer += "  " + std::string(companion.command) + std::string(28 - companion.command.size(), ' ') +
              std::string(companion.what) + "\n";
  program.footer(footer + "\n`mien help COMMAND` explains a command.");

  if (words.empty()) return std::fputs(program.help().c_str(), stderr), 2;
  if (words.front() == "help") return print_help(program, {words.begin() + 1, words.end()}, progress);
  for (const auto& companion : companions())
    if (words.front() == companion.command)
      return report_error(become(companion, std::span(words).subspan(1)), progress);
  if (!words.front().starts_with('-') && find_command(program, words.front()) == nullptr)
    return report_error(unknown_command(program, words.front()), progress);
  try {
    std::vector<std::string> reversed(words.rbegin(), words.rend());  // as CLI11 wants it
    program.parse(reversed);
  } catch (const CLI::Success& e) {  // --help, --version
    return program.exit(e);
  } catch (const CLI::ParseError& e) {
    return report_error(usage_error(program, e, words), progress);
  }
  const Status done = chosen.work(progress);
  return done ? 0 : report_error(done.error(), progress);
}

}  // namespace
}  // namespace mien

int main(int argc, char** argv) {
  try {
    return mien::run({argv + 1, argv + argc});
  } catch (const std::bad_alloc&) {
    std::fputs("error: not enough memory\n", stderr);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "error: a mistake of Mien itself, please report it: %s\n", e.what());
  }
  return 1;
}
