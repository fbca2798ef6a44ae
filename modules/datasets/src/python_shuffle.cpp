#include <array>
#include <bit>
#include <utility>

#include "mien/base/contract.h"
#include "mien/datasets/layout.h"

namespace mien {
namespace {

// Mersenne Twister MT19937 (Matsumoto and Nishimura, 1998), seeded by an array of one number as Python does
// it.
class MersenneTwister {
 public:
  explicit MersenneTwister(std::uint32_t seed) {
    state_[0] = 19650218u;
    for (std::uint32_t i = 1; i < kSize; ++i)
      state_[i] = 1812433253u * (state_[i - 1] ^ (state_[i - 1] >> 30)) + i;
    std::uint32_t i = 1;
    const auto previous = [&] { return state_[i - 1] ^ (state_[i - 1] >> 30); };
    const auto advance = [&] {
      if (++i < kSize) return;
      state_[0] = state_[kSize - 1];
      i = 1;
    };
    for (std::uint32_t k = 0; k < kSize; ++k, advance())
      state_[i] = (state_[i] ^ (previous() * 1664525u)) + seed;
    for (std::uint32_t k = 1; k < kSize; ++k, advance())
      state_[i] = (state_[i] ^ (previous() * 1566083941u)) - i;
    state_[0] = 0x80000000u;
  }

  /// The upper `count` bits of the next number. @pre 1 <= count <= 32
  std::uint32_t bits(int count) {
    if (next_ == kSize) refill();
    std::uint32_t y = state_[next_++];
    y ^= y >> 11;
    y ^= (y << 7) & 0x9d2c5680u;
    y ^= (y << 15) & 0xefc60000u;
    y ^= y >> 18;
    return y >> (32 - count);
  }

 private:
  static constexpr std::uint32_t kSize = 624, kShift = 397;
  void refill() {
    for (std::uint32_t i = 0; i < kSize; ++i) {
      const std::uint32_t y = (state_[i] & 0x80000000u) | (state_[(i + 1) % kSize] & 0x7fffffffu);
      state_[i] = state_[(i + kShift) % kSize] ^ (y >> 1) ^ ((y & 1u) != 0 ? 0x9908b0dfu : 0u);
    }
    next_ = 0;
  }
  std::array<std::uint32_t, kSize> state_;
  std::uint32_t next_ = kSize;
};

}  // namespace

std::vector<int> python_shuffle(int n, std::uint32_t seed) {
  contract(n >= 0, "python_shuffle: a count expected");
  std::vector<int> order(static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i) order[static_cast<std::size_t>(i)] = i + 1;
  MersenneTwister random(seed);
  for (std::uint32_t i = static_cast<std::uint32_t>(n); i-- > 1;) {
    const int width = std::bit_width(i + 1);
    std::uint32_t j = random.bits(width);
    while (j > i) j = random.bits(width);  // below i + 1
    std::swap(order[i], order[j]);
  }
  return order;
}

}  // namespace mien
