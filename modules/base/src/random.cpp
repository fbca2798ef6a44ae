#include "mien/base/random.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mien/base/contract.h"
#include "normal_blocks.h"

namespace mien {
namespace {

double unit53(std::uint32_t high, std::uint32_t low) {
  const std::uint64_t bits = (static_cast<std::uint64_t>(high) << 32) | low;
  return static_cast<double>(bits >> 11) * 0x1p-53;
}

std::array<std::uint32_t, 2> key_of(std::uint64_t seed) {
  return {static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)};
}

}  // namespace

std::array<std::uint32_t, 4> philox4x32(std::array<std::uint32_t, 4> c, std::array<std::uint32_t, 2> k) {
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t p0 = static_cast<std::uint64_t>(0xD2511F53u) * c[0];
    const std::uint64_t p1 = static_cast<std::uint64_t>(0xCD9E8D57u) * c[2];
    c = {static_cast<std::uint32_t>(p1 >> 32) ^ c[1] ^ k[0], static_cast<std::uint32_t>(p1),
         static_cast<std::uint32_t>(p0 >> 32) ^ c[3] ^ k[1], static_cast<std::uint32_t>(p0)};
    k[0] += 0x9E3779B9u;
    k[1] += 0xBB67AE85u;
  }
  return c;
}

void NoiseField::normal(std::uint64_t first_index, std::uint32_t step, std::span<float> out) const {
  // One Philox block makes four values: elements 4b ... 4b+3. kNormalBlocks of them are made at a time.
  const auto key = key_of(seed_);
  std::array<float, 4 * kNormalBlocks> z;
  for (std::size_t i = 0; i < out.size();) {
    const std::uint64_t index = first_index + i;
    normal_blocks(index / 4, step, stream_, key.data(), z.data());
    const std::size_t skipped = index % 4;
    const std::size_t count = std::min(z.size() - skipped, out.size() - i);
    std::copy_n(z.begin() + static_cast<std::ptrdiff_t>(skipped), count,
                out.begin() + static_cast<std::ptrdiff_t>(i));
    i += count;
  }
}

double NoiseField::uniform(std::uint64_t index, std::uint32_t step) const {
  const auto w =
      philox4x32({static_cast<std::uint32_t>(index), static_cast<std::uint32_t>(index >> 32), step, stream_},
                 key_of(seed_));
  return unit53(w[0], w[1]);
}

std::uint32_t Rng::bits() {
  if (used_ == 4) {
    block_ =
        philox4x32({static_cast<std::uint32_t>(counter_), static_cast<std::uint32_t>(counter_ >> 32), 0, 0},
                   key_of(seed_));
    ++counter_;
    used_ = 0;
  }
  return block_[used_++];
}

double Rng::uniform() {
  const std::uint32_t high = bits();
  return unit53(high, bits());
}

std::uint64_t Rng::below(std::uint64_t n) {
  contract(n > 0, "Rng::below: n must be positive");
  const std::uint64_t limit = ~std::uint64_t{0} - ~std::uint64_t{0} % n;
  std::uint64_t x = 0;
  do {
    const std::uint64_t high = bits();
    x = (high << 32) | bits();
  } while (x >= limit);
  return x % n;
}

double Rng::normal(double mean, double sd) {
  if (has_spare_) {
    has_spare_ = false;
    return mean + sd * spare_;
  }
  const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
  const double angle = 2.0 * std::numbers::pi * uniform();
  spare_ = radius * std::sin(angle);
  has_spare_ = true;
  return mean + sd * radius * std::cos(angle);
}

double Rng::log_normal(double mu, double sigma) { return std::exp(normal(mu, sigma)); }
double Rng::exponential(double mean) { return -mean * std::log(1.0 - uniform()); }

}  // namespace mien
