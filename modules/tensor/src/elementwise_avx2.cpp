#include <cstdint>

namespace mien::elementwise {
namespace {
constexpr int kWidth = 8;
}
}  // namespace mien::elementwise

#include "elementwise_kernel.h"

namespace mien::elementwise {
Kernels kernels_avx2() { return kernels(); }
}  // namespace mien::elementwise
