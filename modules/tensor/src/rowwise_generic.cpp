#include <cstdint>

namespace mien::rowwise {
namespace {

// Plain loops for any processor. Exactly rounded like the others: slow only where the processor has no fused
// multiply-add at all (x86 before 2013), because the mathematical library then computes it in software.
struct Lanes {
  float v[16];
  static Lanes zero() { return {}; }
  static Lanes load(const float* p) { return load_unaligned(p); }
  static Lanes load_unaligned(const float* p) {
    Lanes l;
    for (int i = 0; i < 16; ++i) l.v[i] = p[i];
    return l;
  }
  static Lanes broadcast(const float* p) {
    Lanes l;
    for (int i = 0; i < 16; ++i) l.v[i] = *p;
    return l;
  }
  void store(float* p) const {
    for (int i = 0; i < 16; ++i) p[i] = v[i];
  }
  void add_product(const Lanes& a, const Lanes& b) {
    for (int i = 0; i < 16; ++i) v[i] = __builtin_fmaf(a.v[i], b.v[i], v[i]);
  }
};

constexpr int kMaxPanels[] = {0, 4, 3, 2, 1, 1, 1};

}  // namespace
}  // namespace mien::rowwise

#include "rowwise_kernel.h"

namespace mien::rowwise {
void multiply_generic(const Block& block) { multiply(block); }
}  // namespace mien::rowwise
