#pragma once
#include <array>
#include <span>

namespace mien {

/// Power spectrum |X[k]|^2 of 512 real samples, k = 0 ... 256. Own code instead of a library: the sum order
/// is fixed, so the same samples give the same bits in every build, and model code links nothing for it.
class Fft512 {
 public:
  static constexpr int kSize = 512;
  static constexpr int kNumBins = kSize / 2 + 1;

  Fft512();
  void power(std::span<const float, kSize> samples, std::span<float, kNumBins> out) const;

 private:
  static constexpr int kHalf = kSize / 2;
  std::array<float, kHalf> cos_;  // cos(2 pi k / 512)
  std::array<float, kHalf> sin_;  // sin(2 pi k / 512)
};

}  // namespace mien
