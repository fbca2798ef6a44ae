#include "elementwise_dispatch.h"

namespace mien::elementwise {

Kernels kernels_for(InstructionSet set) {
#ifdef MIEN_X86_KERNELS
  if (set == InstructionSet::avx512) return kernels_avx512();
  if (set == InstructionSet::avx2) return kernels_avx2();
#endif
  (void)set;
  return kernels_generic();
}

const Kernels& best_kernels() {
  static const Kernels best = kernels_for(best_instruction_set());
  return best;
}

}  // namespace mien::elementwise
