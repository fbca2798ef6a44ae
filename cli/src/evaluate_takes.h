#pragma once
#include "command.h"

namespace CLI {
class App;
}

namespace mien {

/// `mien evaluate takes`.
void add_take_evaluation(CLI::App& evaluate, Chosen& chosen);

}  // namespace mien
