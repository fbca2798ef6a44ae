#pragma once
#include <array>
#include <cstdint>
#include <span>

namespace mien {

/// Philox4x32-10 (Salmon et al., "Parallel random numbers: as easy as 1, 2, 3", 2011): four 32-bit words that depend on
/// key and counter alone. The basis of all randomness in Mien: the same (key, counter) gives the same bits on every
/// platform, in any order and from any thread.
std::array<std::uint32_t, 4> philox4x32(std::array<std::uint32_t, 4> counter, std::array<std::uint32_t, 2> key);

/// Standard normal noise addressed by position instead of drawn in sequence: value (index, step) of a stream is the same
/// whatever was asked before. Diffusion noise is keyed by seed and stream, with index = frame * channels + channel.
class NoiseField {
 public:
  NoiseField(std::uint64_t seed, std::uint32_t stream) : seed_(seed), stream_(stream) {}

  /// out[i] = the N(0,1) value of element first_index + i at `step`.
  void normal(std::uint64_t first_index, std::uint32_t step, std::span<float> out) const;
  /// The uniform value in [0, 1) of element `index` at `step`.
  [[nodiscard]] double uniform(std::uint64_t index, std::uint32_t step) const;

 private:
  std::uint64_t seed_;
  std::uint32_t stream_;
};

/// A sequence of random numbers for code that draws one after the other (corpus takes, shuffling). Counter-based
/// underneath, so it is cheap to create one per item: Rng(hash_combine(seed, item)).
class Rng {
 public:
  explicit Rng(std::uint64_t seed) : seed_(seed) {}

  std::uint32_t bits();
  /// In [0, 1), 53 bits.
  double uniform();
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// In 0 ... n-1, unbiased. @pre n > 0
  std::uint64_t below(std::uint64_t n);
  /// N(mean, sd), by Box-Muller (both values are used in turn).
  double normal(double mean = 0.0, double sd = 1.0);
  /// exp(N(mu, sigma)).
  double log_normal(double mu, double sigma);
  /// Mean 1/rate given as mean.
  double exponential(double mean);
  bool chance(double probability) { return uniform() < probability; }

 private:
  std::uint64_t seed_;
  std::uint64_t counter_ = 0;
  std::array<std::uint32_t, 4> block_{};
  int used_ = 4;
  bool has_spare_ = false;
  double spare_ = 0.0;
};

}  // namespace mien
