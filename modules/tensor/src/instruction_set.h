#pragma once
#include <string_view>
#include <vector>

namespace mien {

/// Instruction sets that kernels are built for, in rising order.
enum class InstructionSet { generic, avx2, avx512 };

std::string_view instruction_set_name(InstructionSet set);
/// What this build and this processor can run; generic is always first.
std::vector<InstructionSet> usable_instruction_sets();
/// The last of usable_instruction_sets(), found once.
InstructionSet best_instruction_set();

}  // namespace mien
