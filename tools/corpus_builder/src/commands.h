#pragma once
#include <functional>

namespace CLI {
class App;
}

namespace mien {

/// Adds one sub-command to the program. What it returns runs the command after parsing and gives the exit
/// code.
using Command = std::function<int()>;
Command add_list_command(CLI::App& app);
Command add_prepare_command(CLI::App& app);
Command add_check_command(CLI::App& app);
Command add_build_command(CLI::App& app);

}  // namespace mien
