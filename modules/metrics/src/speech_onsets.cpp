#include "mien/metrics/speech_onsets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdint>
#include <limits>
#include <numbers>
#include <unsupported/Eigen/FFT>

#include "mien/core/audio_clip.h"

namespace mien {
namespace {

constexpr std::int64_t kWindow = 2048, kHop = 512, kBins = kWindow / 2 + 1, kBands = 128;
constexpr double kRate = kModelSampleRateHz;
// Peaks (librosa's 0.1 s before and after, in whole frames, and its threshold).
constexpr std::int64_t kFramesBefore = 3, kFramesFrom = 4;
constexpr double kAbove = 0.07;

// Slaney's mel scale: linear to 1 kHz, logarithmic above.
double mel_of(double hz) {
  constexpr double kPerHz = 3.0 / 200, kBreak = 1000;
  const double step = std::log(6.4) / 27;
  return hz < kBreak ? hz * kPerHz : kBreak * kPerHz + std::log(hz / kBreak) / step;
}
double hz_of(double mel) {
  constexpr double kHzPer = 200.0 / 3, kBreak = 15;
  const double step = std::log(6.4) / 27;
  return mel < kBreak ? mel * kHzPer : 1000 * std::exp(step * (mel - kBreak));
}

using Bands = std::array<double, kBands>;
using Weights = std::vector<std::array<double, kBins>>;

// Triangles of equal area between equally spaced mels.
Weights mel_weights() {
  std::array<double, kBands + 2> edges{};
  for (std::size_t i = 0; i < edges.size(); ++i)
    edges[i] = hz_of(mel_of(kRate / 2) * static_cast<double>(i) / static_cast<double>(kBands + 1));
  Weights weights(static_cast<std::size_t>(kBands));
  for (std::size_t b = 0; b < weights.size(); ++b)
    for (std::size_t k = 0; k < weights[b].size(); ++k) {
      const double hz = static_cast<double>(k) * kRate / static_cast<double>(kWindow);
      const double rise = (hz - edges[b]) / (edges[b + 1] - edges[b]),
                   fall = (edges[b + 2] - hz) / (edges[b + 2] - edges[b + 1]);
      weights[b][k] = std::max(0.0, std::min(rise, fall)) * 2 / (edges[b + 2] - edges[b]);
    }
  return weights;
}

// Decibels of the bands, frame t centred on sample 512 t with zeros beyond the ends.
std::vector<Bands> band_levels(std::span<const float> samples) {
  const auto num_samples = static_cast<std::int64_t>(samples.size());
  const Weights weights = mel_weights();
  std::vector<double> shape(static_cast<std::size_t>(kWindow)), piece(shape.size());
  for (std::size_t i = 0; i < shape.size(); ++i)
    shape[i] =
        0.5 - 0.5 * std::cos(2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(kWindow));
  Eigen::FFT<double> transform;
  transform.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  std::vector<std::complex<double>> spectrum;
  std::vector<Bands> levels(static_cast<std::size_t>(num_samples / kHop + 1));
  double most = -std::numeric_limits<double>::infinity();
  for (std::size_t t = 0; t < levels.size(); ++t) {
    const std::int64_t first = static_cast<std::int64_t>(t) * kHop - kWindow / 2;
    for (std::int64_t i = 0; i < kWindow; ++i) {
      const std::int64_t at = first + i;
      const double x =
          at >= 0 && at < num_samples ? static_cast<double>(samples[static_cast<std::size_t>(at)]) : 0;
      piece[static_cast<std::size_t>(i)] = x * shape[static_cast<std::size_t>(i)];
    }
    transform.fwd(spectrum, piece);
    for (std::size_t b = 0; b < levels[t].size(); ++b) {
      double power = 0;
      for (std::size_t k = 0; k < spectrum.size(); ++k) power += weights[b][k] * std::norm(spectrum[k]);
      levels[t][b] = 10 * std::log10(std::max(1e-10, power));
      most = std::max(most, levels[t][b]);
    }
  }
  constexpr double kRangeDb = 80;
  for (Bands& bands : levels)
    for (double& level : bands) level = std::max(level, most - kRangeDb);
  return levels;
}

// Mean rise of the bands, 0 ... 1, delayed by half a window; empty when nothing rises.
std::vector<double> rises(const std::vector<Bands>& levels) {
  constexpr std::size_t kDelay = 1 + kWindow / (2 * kHop);
  std::vector<double> rise(levels.size(), 0.0);
  for (std::size_t t = 1; t + kDelay - 1 < levels.size(); ++t) {
    double sum = 0;
    for (std::size_t b = 0; b < levels[t].size(); ++b) sum += std::max(0.0, levels[t][b] - levels[t - 1][b]);
    rise[t + kDelay - 1] = sum / static_cast<double>(kBands);
  }
  const auto [least, most] = std::ranges::minmax(rise);
  if (!(most > least)) return {};
  for (double& r : rise) r = (r - least) / (most - least);
  return rise;
}

}  // namespace

std::vector<double> speech_onsets(std::span<const float> samples_16k) {
  std::vector<double> onsets;
  const std::vector<double> rise = rises(band_levels(samples_16k));
  const auto count = static_cast<std::int64_t>(rise.size());
  for (std::int64_t n = 0; n < count; ++n) {
    const std::int64_t from = std::max<std::int64_t>(0, n - kFramesBefore),
                       to = std::min(count, n + kFramesFrom);
    double mean = 0;
    for (std::int64_t i = from; i < to; ++i)
      mean += rise[static_cast<std::size_t>(i)] / static_cast<double>(to - from);
    if (rise[static_cast<std::size_t>(n)] >= mean + kAbove)
      onsets.push_back(static_cast<double>(n * kHop) / kRate);
  }
  return onsets;
}

}  // namespace mien
