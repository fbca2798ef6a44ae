#pragma once
#include "command.h"

namespace CLI {
class App;
}

namespace mien {

/// `mien evaluate vertices` and `mien evaluate controls`.
void add_sequence_evaluations(CLI::App& evaluate, Chosen& chosen);

}  // namespace mien
