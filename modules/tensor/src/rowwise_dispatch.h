#pragma once
#include "instruction_set.h"
#include "mien/tensor/aligned_floats.h"
#include "rowwise.h"

namespace mien::rowwise {

/// @param is_bf16  of pairs of bfloat16. @pre rowwise_bf16_available()
/// @pre set is one of usable_instruction_sets()
Multiply multiply_for(InstructionSet set, bool is_bf16 = false);
/// Weights [num_outputs, num_inputs] row-major -> panels, see Block.
AlignedFloats pack_panels(const float* weights, std::int64_t num_outputs, std::int64_t num_inputs);

}  // namespace mien::rowwise
