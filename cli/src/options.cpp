#include "options.h"

namespace mien {

void add_console_options(CLI::App& command, Chosen& chosen) {
  command.add_flag("--quiet", chosen.quiet, "Print errors only");
  command.add_flag("--json", chosen.json, "Print one JSON object a line instead of text (docs/formats.md)");
}

void add_threads_option(CLI::App& command, int& threads) {
  command.add_option("--threads", threads, "Threads, 1 to 256; the result is the same for any number")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
}

void add_view_option(CLI::App& command, std::string& view) {
  command.add_option("--view", view, "front, portrait, three-quarter, side or mouth")->capture_default_str();
}

void add_sheet_options(CLI::App& command, std::string& times, int& columns, const std::string& several) {
  command.add_option(
      "--times", times,
      "Instants of a contact sheet (.png) in seconds: 0.5,1.25. Default: evenly spread, twelve, or "
      "six of several " +
          several);
  command
      .add_option("--columns", columns,
                  "Pictures in a row of a contact sheet, faces in a row of several side by side, 1 to 64")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
}

void add_footer(CLI::App& command, std::string_view examples) {
  command.footer(
      "Examples:\n" + std::string(examples) +
      "Exit codes: 0 done, 1 failed, 2 wrong usage, 3 input missing or unreadable, 4 model, character "
      "and\ninput do not fit together, 130 interrupted.");
}

}  // namespace mien
