#include <cstdint>

namespace mien::elementwise {
namespace {
constexpr int kWidth = 16;
}
}  // namespace mien::elementwise

#include "elementwise_kernel.h"

namespace mien::elementwise {
Kernels kernels_avx512() { return kernels(); }
}  // namespace mien::elementwise
