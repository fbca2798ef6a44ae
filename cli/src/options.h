#pragma once
#include <CLI/CLI.hpp>
#include <string>
#include <string_view>

#include "command.h"

namespace mien {

/// --quiet and --json.
void add_console_options(CLI::App& command, Chosen& chosen);
/// --threads, by default all processors.
void add_threads_option(CLI::App& command, int& threads);
/// Examples that work, then the exit codes.
void add_footer(CLI::App& command, std::string_view examples);

}  // namespace mien
