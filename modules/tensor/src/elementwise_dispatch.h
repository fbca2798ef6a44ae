#pragma once
#include "elementwise.h"
#include "instruction_set.h"

namespace mien::elementwise {

/// @pre set is one of usable_instruction_sets()
Kernels kernels_for(InstructionSet set);
/// For best_instruction_set().
const Kernels& best_kernels();

}  // namespace mien::elementwise
