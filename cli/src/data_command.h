#pragma once
#include "command.h"

namespace CLI {
class App;
}

namespace mien {

/// `mien data check` and `mien data prepare`.
void add_data_command(CLI::App& program, Chosen& chosen);

}  // namespace mien
