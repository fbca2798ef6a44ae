#include "filters.h"

#include <soxr.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <unsupported/Eigen/FFT>

#include "mien/base/contract.h"
#include "mien/core/audio_clip.h"

namespace mien {
namespace {

constexpr double kRate = kModelSampleRateHz;
constexpr double kActive = 0.003;    // |x| above which a sample counts as speech
constexpr double kTargetRms = 0.06;  // loudness every item is brought to

// Second-order section in transposed direct form II; the coefficients follow from the bilinear transform.
struct Biquad {
  double b0, b1, b2, a1, a2;

  void run(std::span<float> x) const {
    double s1 = 0, s2 = 0;
    for (auto& v : x) {
      const double in = v, out = b0 * in + s1;
      s1 = b1 * in - a1 * out + s2;
      s2 = b2 * in - a2 * out;
      v = static_cast<float>(out);
    }
  }
};

Biquad butterworth_section(double hz, double q, bool high) {
  const double w = 2 * std::numbers::pi * hz / kRate, alpha = std::sin(w) / (2 * q), c = std::cos(w);
  const double a0 = 1 + alpha;
  const double edge = high ? (1 + c) / 2 : (1 - c) / 2;
  return {edge / a0, (high ? -2 : 2) * edge / a0, edge / a0, -2 * c / a0, (1 - alpha) / a0};
}

}  // namespace

double active_rms(std::span<const float> x) {
  double sum = 0;
  std::size_t count = 0;
  for (const float v : x)
    if (std::abs(v) > kActive) sum += static_cast<double>(v) * v, ++count;
  return count == 0 ? 0.0 : std::sqrt(sum / static_cast<double>(count));
}

void normalise_loudness(std::span<float> x) {
  const double rms = active_rms(x);
  if (rms <= 0) return;
  const auto gain = static_cast<float>(kTargetRms / rms);
  for (auto& v : x) v *= gain;
}

std::vector<float> low_pass(std::span<const float> x, double hz) {
  // Bilinear transform of the RC filter: exactly -3 dB at hz, a zero at 8 kHz.
  const double k = std::tan(std::numbers::pi * hz / kRate), in_gain = k / (1 + k),
               feedback = (1 - k) / (1 + k);
  std::vector<float> y(x.size());
  double last_in = 0, last_out = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    last_out = in_gain * (x[i] + last_in) + feedback * last_out;
    last_in = x[i];
    y[i] = static_cast<float>(last_out);
  }
  return y;
}

void high_shelf(std::span<float> x, double hz, double gain_db) {
  if (gain_db == 0) return;
  const auto low = low_pass(x, hz);
  const auto gain = static_cast<float>(std::pow(10.0, gain_db / 20));
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = low[i] + gain * (x[i] - low[i]);
}

void band_limit(std::span<float> x, double low_hz, double high_hz) {
  contract(low_hz > 0 && high_hz < kRate / 2, "band_limit: edges outside (0, 8000) Hz");
  // Pole pairs of the fourth-order Butterworth: Q = 1 / (2 cos(pi/8)) and 1 / (2 cos(3 pi/8)).
  for (const double angle : {std::numbers::pi / 8, 3 * std::numbers::pi / 8}) {
    const double q = 1 / (2 * std::cos(angle));
    butterworth_section(low_hz, q, true).run(x);
    butterworth_section(high_hz, q, false).run(x);
  }
}

std::vector<float> convolve(std::span<const float> x, std::span<const float> kernel) {
  if (x.empty() || kernel.empty()) return std::vector<float>(x.size(), 0.0f);
  // Overlap-add in blocks of the kernel's length.
  std::size_t size = 1;
  while (size < 2 * kernel.size()) size *= 2;
  const std::size_t block = size - kernel.size() + 1;
  Eigen::FFT<double> fft;
  const auto spectrum = [&](std::span<const float> part) {
    std::vector<double> padded(size, 0.0);
    std::copy(part.begin(), part.end(), padded.begin());
    std::vector<std::complex<double>> out;
    fft.fwd(out, padded);
    return out;
  };
  const auto response = spectrum(kernel);
  std::vector<double> sum(x.size() + size, 0.0), back;
  for (std::size_t at = 0; at < x.size(); at += block) {
    auto part = spectrum(x.subspan(at, std::min(block, x.size() - at)));
    for (std::size_t i = 0; i < part.size(); ++i) part[i] *= response[i];
    fft.inv(back, part);
    for (std::size_t i = 0; i < size; ++i) sum[at + i] += back[i];
  }
  std::vector<float> y(x.size());
  for (std::size_t i = 0; i < y.size(); ++i) y[i] = static_cast<float>(sum[i]);
  return y;
}

std::vector<float> resample_audio(std::span<const float> x, double from_hz, double to_hz) {
  contract(from_hz > 0 && to_hz > 0, "resample_audio: rates must be positive");
  if (from_hz == to_hz || x.empty()) return {x.begin(), x.end()};
  const auto count = static_cast<std::size_t>(std::llround(static_cast<double>(x.size()) * to_hz / from_hz));
  std::vector<float> y(count, 0.0f);
  std::size_t used = 0, made = 0;
  const auto quality = soxr_quality_spec(SOXR_HQ, 0);
  const soxr_error_t error = soxr_oneshot(from_hz, to_hz, 1, x.data(), x.size(), &used, y.data(), y.size(),
                                          &made, nullptr, &quality, nullptr);
  contract(error == nullptr, "resample_audio: soxr refuses the rates");
  return y;
}

std::vector<float> tremor(std::span<const float> x, double hz, double depth) {
  std::vector<float> y(x.size());
  const double swing = depth / (2 * std::numbers::pi * hz) * kRate;
  const auto last = static_cast<std::int64_t>(x.size()) - 1;
  const auto at = [&](std::int64_t i) {
    return static_cast<double>(x[static_cast<std::size_t>(std::clamp<std::int64_t>(i, 0, last))]);
  };
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double t = static_cast<double>(i);
    const double position = t + swing * std::sin(2 * std::numbers::pi * hz * t / kRate);
    const double base = std::floor(position), u = position - base;
    const auto n = static_cast<std::int64_t>(base);
    // Catmull-Rom: the swing is slow, so the cubic's droop near 8 kHz hardly moves.
    const double p0 = at(n - 1), p1 = at(n), p2 = at(n + 1), p3 = at(n + 2);
    y[i] = static_cast<float>(
        p1 + 0.5 * u * (p2 - p0 + u * (2 * p0 - 5 * p1 + 4 * p2 - p3 + u * (3 * (p1 - p2) + p3 - p0))));
  }
  return y;
}

}  // namespace mien
