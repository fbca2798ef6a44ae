#pragma once
#include "command.h"

namespace mien {

/// Adds `mien evaluate coefficients`.
void add_coefficient_evaluation(CLI::App& evaluate, Chosen& chosen);

}  // namespace mien
