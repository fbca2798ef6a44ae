#include <immintrin.h>

#include <cstdint>

namespace mien::rowwise {
namespace {

/// Pairs of bfloat16 in the place of floats: a step of k multiplies both of a pair and adds both products.
struct Lanes {
  __m512 v;
  static Lanes zero() { return {_mm512_setzero_ps()}; }
  static Lanes load(const float* p) { return {_mm512_load_ps(p)}; }
  static Lanes load_unaligned(const float* p) { return {_mm512_loadu_ps(p)}; }
  static Lanes broadcast(const float* p) { return {_mm512_set1_ps(*p)}; }
  void store(float* p) const { _mm512_storeu_ps(p, v); }
  void add_product(const Lanes& a, const Lanes& b) {
    v = _mm512_dpbf16_ps(v, reinterpret_cast<__m512bh>(a.v), reinterpret_cast<__m512bh>(b.v));
  }
};

// As in rowwise_avx512.cpp.
constexpr int kMaxPanels[] = {0, 12, 10, 8, 6, 4, 4};

}  // namespace
}  // namespace mien::rowwise

#include "rowwise_kernel.h"

namespace mien::rowwise {
void multiply_avx512bf16(const Block& block) { multiply(block); }
}  // namespace mien::rowwise
