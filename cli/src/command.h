#pragma once
#include <functional>
#include <string>

#include "mien/base/result.h"
#include "mien/console/console_progress.h"

namespace CLI {
class App;
}

namespace mien {

/// What the command line asked for. Each sub-command fills it when it was the chosen one.
struct Chosen {
  std::function<Status(ConsoleProgress&)> work;
  bool quiet = false;
  bool json = false;
};

// One sub-command each: declare its options, and leave its work in `chosen` when it was named.
void add_animate_command(CLI::App& program, Chosen& chosen);
void add_edit_command(CLI::App& program, Chosen& chosen);
void add_render_command(CLI::App& program, Chosen& chosen);
void add_inspect_command(CLI::App& program, Chosen& chosen);
void add_import_command(CLI::App& program, Chosen& chosen);
void add_evaluate_command(CLI::App& program, Chosen& chosen);
void add_fit_command(CLI::App& program, Chosen& chosen);
void add_transfer_command(CLI::App& program, Chosen& chosen);

}  // namespace mien
