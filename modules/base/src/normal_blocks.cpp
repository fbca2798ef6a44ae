#include "normal_blocks.h"

#include <bit>
#include <cmath>
#include <numbers>

// Loops over blocks become vector code, compiled for several processors; the loader picks. Plain IEEE
// operations without contraction: all give the same bits. Sanitizers start too late for that choice.
#if defined(__x86_64__) && defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__) && defined(__GNUC__) && !defined(__clang__)
#define MIEN_FOR_SEVERAL_PROCESSORS __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define MIEN_FOR_SEVERAL_PROCESSORS
#endif

namespace mien {
namespace {

constexpr int kN = kNormalBlocks;

// ln of x in [2^-32, 1]: x = 2^e m with m in [sqrt(1/2), sqrt(2)), ln m = 2 artanh(s), s = (m - 1) / (m + 1),
// as its Taylor series; s^2 < 0.0295, so ten terms are exact to double.
inline double log_of(double x) {
  const auto bits = std::bit_cast<std::uint64_t>(x);
  constexpr std::uint64_t kHalfRoot = 0x3fe6a09e667f3bcdULL;  // sqrt(1/2)
  const auto exponent = static_cast<std::int64_t>(bits - kHalfRoot) >> 52;
  const auto m = std::bit_cast<double>(bits - (static_cast<std::uint64_t>(exponent) << 52));
  const double s = (m - 1) / (m + 1), z = s * s;
  double p = 1.0 / 21;
  p = p * z + 1.0 / 19;
  p = p * z + 1.0 / 17;
  p = p * z + 1.0 / 15;
  p = p * z + 1.0 / 13;
  p = p * z + 1.0 / 11;
  p = p * z + 1.0 / 9;
  p = p * z + 1.0 / 7;
  p = p * z + 1.0 / 5;
  p = p * z + 1.0 / 3;
  return static_cast<double>(static_cast<std::int32_t>(exponent)) * std::numbers::ln2 + 2 * (s + s * z * p);
}

// Taylor series for |x| <= pi / 4.
inline double sin_of(double x) {
  const double z = x * x;
  double p = 1.0 / 355687428096000;
  p = p * z - 1.0 / 1307674368000;
  p = p * z + 1.0 / 6227020800;
  p = p * z - 1.0 / 39916800;
  p = p * z + 1.0 / 362880;
  p = p * z - 1.0 / 5040;
  p = p * z + 1.0 / 120;
  p = p * z - 1.0 / 6;
  return x + x * z * p;
}
inline double cos_of(double x) {
  const double z = x * x;
  double p = 1.0 / 20922789888000;
  p = p * z - 1.0 / 87178291200;
  p = p * z + 1.0 / 479001600;
  p = p * z - 1.0 / 3628800;
  p = p * z + 1.0 / 40320;
  p = p * z - 1.0 / 720;
  p = p * z + 1.0 / 24;
  p = p * z - 0.5;
  return 1 + z * p;
}

}  // namespace

MIEN_FOR_SEVERAL_PROCESSORS
void normal_blocks(std::uint64_t first_block, std::uint32_t step, std::uint32_t stream,
                   const std::uint32_t* key, float* out) {
  std::uint32_t c[4][kN];
  for (int i = 0; i < kN; ++i) {
    const std::uint64_t block = first_block + static_cast<std::uint64_t>(i);
    c[0][i] = static_cast<std::uint32_t>(block);
    c[1][i] = static_cast<std::uint32_t>(block >> 32);
    c[2][i] = step;
    c[3][i] = stream;
  }
  std::uint32_t k0 = key[0], k1 = key[1];
  for (int round = 0; round < 10; ++round) {  // as philox4x32()
    for (int i = 0; i < kN; ++i) {
      const std::uint64_t p0 = static_cast<std::uint64_t>(0xD2511F53u) * c[0][i];
      const std::uint64_t p1 = static_cast<std::uint64_t>(0xCD9E8D57u) * c[2][i];
      c[0][i] = static_cast<std::uint32_t>(p1 >> 32) ^ c[1][i] ^ k0;
      c[1][i] = static_cast<std::uint32_t>(p1);
      c[2][i] = static_cast<std::uint32_t>(p0 >> 32) ^ c[3][i] ^ k1;
      c[3][i] = static_cast<std::uint32_t>(p0);
    }
    k0 += 0x9E3779B9u;
    k1 += 0xBB67AE85u;
  }
  float z[4][kN];
  for (int pair = 0; pair < 2; ++pair) {
    for (int i = 0; i < kN; ++i) {
      // Uniform in (0, 1]: never zero, so that its logarithm is finite.
      const double u = (static_cast<double>(c[2 * pair][i]) + 1.0) * 0x1p-32;
      const double radius = std::sqrt(-2.0 * log_of(u));
      // The angle in quarters of a turn and a rest of at most half a quarter, exactly.
      const std::uint32_t angle = c[2 * pair + 1][i];
      const std::uint32_t quarter = (angle + 0x20000000u) >> 30;
      const auto rest = static_cast<std::int32_t>(angle - (quarter << 30));
      const double x = static_cast<double>(rest) * (2.0 * std::numbers::pi * 0x1p-32);
      const double s = sin_of(x), co = cos_of(x);
      const double across = (quarter & 1) != 0 ? -s : co, up = (quarter & 1) != 0 ? co : s;
      const double sign = (quarter & 2) != 0 ? -radius : radius;
      z[2 * pair][i] = static_cast<float>(sign * across);
      z[2 * pair + 1][i] = static_cast<float>(sign * up);
    }
  }
  for (int i = 0; i < kN; ++i)
    for (int j = 0; j < 4; ++j) out[4 * i + j] = z[j][i];
}

}  // namespace mien
