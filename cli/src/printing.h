#pragma once
#include <string_view>

#include "command.h"
#include "mien/metrics/report.h"

namespace mien {

/// A result on standard output. Errors (Errc::failed): it cannot be written.
Status print(std::string_view text);

/// How a table of metrics is printed: as text, unless one of these is chosen.
struct TableForm {
  bool json = false, markdown = false;
};

/// The options --json, --markdown and --quiet of a command that prints a table. Both outlive the command.
void add_table_options(CLI::App& command, TableForm& form, Chosen& chosen);

/// @param defines  below a table in text, a line for each row that says what it is
Status print(const MetricTable& table, const TableForm& form, bool defines);

}  // namespace mien
