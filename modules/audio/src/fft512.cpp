#include "fft512.h"

#include <cmath>
#include <numbers>
#include <utility>

namespace mien {

Fft512::Fft512() {
  for (int k = 0; k < kHalf; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / kSize;
    cos_[k] = static_cast<float>(std::cos(angle));
    sin_[k] = static_cast<float>(std::sin(angle));
  }
}

// The 512 real samples are read as 256 complex ones z[n] = x[2n] + i x[2n+1]; Z is their radix-4 Stockham
// transform (four passes, output in natural order), and X follows from Z by the symmetry of real signals:
//   X[k] = (Z[k] + conj Z[256-k]) / 2 - i/2 exp(-2 pi i k / 512) (Z[k] - conj Z[256-k]).
void Fft512::power(std::span<const float, kSize> samples, std::span<float, kNumBins> out) const {
  std::array<float, kHalf> buffers[4];
  float* re = buffers[0].data();
  float* im = buffers[1].data();
  float* next_re = buffers[2].data();
  float* next_im = buffers[3].data();
  for (int n = 0; n < kHalf; ++n) {
    re[n] = samples[2 * n];
    im[n] = samples[2 * n + 1];
  }
  // Pass: sub-transforms of length `length`, `stride` of them interleaved.
  for (int length = kHalf, stride = 1; length > 1; length /= 4, stride *= 4) {
    const int quarter = length / 4;
    for (int p = 0; p < quarter; ++p) {
      // exp(-2 pi i p j / length), j = 1, 2, 3; the tables count 1/512 turns.
      const int turn = p * (kSize / length);
      const float c1 = cos_[turn], s1 = -sin_[turn];
      const float c2 = c1 * c1 - s1 * s1, s2 = 2.0f * c1 * s1;
      const float c3 = c1 * c2 - s1 * s2, s3 = c1 * s2 + s1 * c2;
      const int in = stride * p, step = stride * quarter, to = stride * 4 * p;
      for (int q = 0; q < stride; ++q) {
        const int i = in + q, o = to + q;
        const float ar = re[i], ai = im[i];
        const float br = re[i + step], bi = im[i + step];
        const float cr = re[i + 2 * step], ci = im[i + 2 * step];
        const float dr = re[i + 3 * step], di = im[i + 3 * step];
        const float sum_r = ar + cr, sum_i = ai + ci, diff_r = ar - cr, diff_i = ai - ci;
        const float odd_r = br + dr, odd_i = bi + di;
        const float turn_r = bi - di, turn_i = dr - br;  // -i (b - d)
        next_re[o] = sum_r + odd_r;
        next_im[o] = sum_i + odd_i;
        const float xr = diff_r + turn_r, xi = diff_i + turn_i;
        next_re[o + stride] = xr * c1 - xi * s1;
        next_im[o + stride] = xr * s1 + xi * c1;
        const float yr = sum_r - odd_r, yi = sum_i - odd_i;
        next_re[o + 2 * stride] = yr * c2 - yi * s2;
        next_im[o + 2 * stride] = yr * s2 + yi * c2;
        const float zr = diff_r - turn_r, zi = diff_i - turn_i;
        next_re[o + 3 * stride] = zr * c3 - zi * s3;
        next_im[o + 3 * stride] = zr * s3 + zi * c3;
      }
    }
    std::swap(re, next_re);
    std::swap(im, next_im);
  }
  const float dc = re[0] + im[0], nyquist = re[0] - im[0];
  out[0] = dc * dc;
  out[kHalf] = nyquist * nyquist;
  for (int k = 1; k < kHalf; ++k) {
    const int m = kHalf - k;
    const float even_r = 0.5f * (re[k] + re[m]), even_i = 0.5f * (im[k] - im[m]);
    const float odd_r = 0.5f * (im[k] + im[m]), odd_i = 0.5f * (re[m] - re[k]);
    const float x_r = even_r + odd_r * cos_[k] + odd_i * sin_[k];
    const float x_i = even_i + odd_i * cos_[k] - odd_r * sin_[k];
    out[k] = x_r * x_r + x_i * x_i;
  }
}

}  // namespace mien
