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
/// --view of pictures (check_view()).
void add_view_option(CLI::App& command, std::string& view);
/// --times (parse_times()) and --columns of a contact sheet. @param several  what has fewer instants:
/// "motions"
void add_sheet_options(CLI::App& command, std::string& times, int& columns, const std::string& several);
/// Examples that work, then the exit codes.
void add_footer(CLI::App& command, std::string_view examples);

}  // namespace mien
