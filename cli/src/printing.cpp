#include "printing.h"

#include <CLI/CLI.hpp>
#include <cstdio>

namespace mien {

Status print(std::string_view text) {
  std::fwrite(text.data(), 1, text.size(), stdout);
  if (std::fflush(stdout) != 0) return Error{Errc::failed, "standard output", "cannot be written", ""};
  return Done{};
}

void add_table_options(CLI::App& command, TableForm& form, Chosen& chosen) {
  command.add_flag("--markdown", form.markdown, "Print the table as markdown");
  command.add_flag("--quiet", chosen.quiet, "Print no progress");
  command.add_flag("--json", chosen.json, "Print the table as JSON, progress as JSON lines on stderr");
}

Status print(const MetricTable& table, const TableForm& form, bool defines) {
  if (form.json) return print(to_json(table) + "\n");
  if (form.markdown) return print(to_markdown(table));
  std::string text = to_text(table);
  if (defines)
    for (const auto& row : table.rows) text += row.name + " = " + row.definition + "\n";
  return print(text);
}

}  // namespace mien
