#include <immintrin.h>

#include <cstdint>

namespace mien::rowwise {
namespace {

struct Lanes {
  __m256 low, high;
  static Lanes zero() { return {_mm256_setzero_ps(), _mm256_setzero_ps()}; }
  static Lanes load(const float* p) { return {_mm256_load_ps(p), _mm256_load_ps(p + 8)}; }
  static Lanes load_unaligned(const float* p) { return {_mm256_loadu_ps(p), _mm256_loadu_ps(p + 8)}; }
  static Lanes broadcast(const float* p) {
    const __m256 v = _mm256_broadcast_ss(p);
    return {v, v};
  }
  void store(float* p) const {
    _mm256_storeu_ps(p, low);
    _mm256_storeu_ps(p + 8, high);
  }
  void add_product(const Lanes& a, const Lanes& b) {
    low = _mm256_fmadd_ps(a.low, b.low, low);
    high = _mm256_fmadd_ps(a.high, b.high, high);
  }
};

// 16 registers of 8 floats, two for each panel: at most 12 for accumulators.
constexpr int kMaxPanels[] = {0, 5, 3, 2, 1, 1, 1};

}  // namespace
}  // namespace mien::rowwise

#include "rowwise_kernel.h"

namespace mien::rowwise {
void multiply_avx2(const Block& block) { multiply(block); }
}  // namespace mien::rowwise
