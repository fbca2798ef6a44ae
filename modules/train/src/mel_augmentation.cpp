#include "mel_augmentation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "mien/audio/log_mel.h"
#include "mien/base/contract.h"

namespace mien::train {
namespace {

constexpr auto kBands = static_cast<std::size_t>(kNumMelBands);
constexpr double kNepersPerDb = std::numbers::ln10 / 10;  // of power
constexpr float kMasked = -8.0f;                          // a mask looks like quiet, which the network knows

std::size_t num_frames(std::span<const float> mel) {
  contract(mel.size() % kBands == 0, "mel augmentation: whole frames of 64 bands");
  return mel.size() / kBands;
}

// ln(e^a + e^b)
float log_sum(float a, float b) {
  const float high = std::max(a, b), low = std::min(a, b);
  return low < high - 12 ? high : high + std::log1p(std::exp(low - high));
}

void warp_bands(std::span<float> mel, double warp, const std::array<float, kBands>& offset) {
  std::array<float, kBands> frame;
  for (std::size_t t = 0; t < num_frames(mel); ++t) {
    float* row = mel.data() + t * kBands;
    std::copy(row, row + kBands, frame.begin());
    for (std::size_t b = 0; b < kBands; ++b) {
      const double position = std::min(static_cast<double>(b) * warp, static_cast<double>(kBands - 1));
      const auto left = static_cast<std::size_t>(position);
      const auto right = std::min(left + 1, kBands - 1);
      const auto w = static_cast<float>(position - static_cast<double>(left));
      row[b] = frame[left] + w * (frame[right] - frame[left]) + offset[b];
    }
  }
}

void mask(std::span<float> mel, Rng& rng) {
  const std::size_t frames = num_frames(mel);
  for (int i = 0; i < 2; ++i) {
    const auto width = rng.below(8), first = rng.below(kBands - width + 1);
    for (std::size_t t = 0; t < frames; ++t) std::fill_n(mel.data() + t * kBands + first, width, kMasked);
  }
  const auto width = std::min<std::uint64_t>(rng.below(11), frames);
  const auto first = rng.below(frames - width + 1);
  std::fill_n(mel.data() + first * kBands, width * kBands, kMasked);
}

// Of the frames' values, what 95 % lie below.
double ninety_fifth(std::vector<double> values) {
  const auto at = static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

// Level of the loud frames as the running level measures it (mean of ln power over bands), and as ln mean
// power.
struct Loudness {
  double level, power;
};
Loudness loudness(std::span<const float> mel) {
  std::vector<double> levels, powers;
  for (std::size_t t = 0; t < num_frames(mel); ++t) {
    double level = 0, power = 0;
    for (const float v : mel.subspan(t * kBands, kBands)) {
      level += v / static_cast<double>(kBands);
      power += std::exp(static_cast<double>(v)) / static_cast<double>(kBands);
    }
    levels.push_back(level);
    powers.push_back(power);
  }
  return {ninety_fifth(std::move(levels)), std::log(ninety_fifth(std::move(powers)))};
}

}  // namespace

void add_reverberation(std::span<float> mel, double rt60_s, double tail_ratio) {
  // 60 dB in rt60 seconds; the tail's energy adds up to tail_ratio of what caused it.
  const double keep = std::exp(-60 * kNepersPerDb / (rt60_s * kMelFrameRateHz));
  const double feed = tail_ratio * (1 - keep);
  std::array<double, kBands> tail{};
  for (std::size_t t = 0; t < num_frames(mel); ++t) {
    float* row = mel.data() + t * kBands;
    for (std::size_t b = 0; b < kBands; ++b) {
      const double direct = std::exp(static_cast<double>(row[b]));
      row[b] = static_cast<float>(std::log(direct + tail[b]));
      tail[b] = keep * tail[b] + feed * direct;
    }
  }
}

void add_noise(std::span<float> mel, double snr_db, Rng& rng) {
  if (mel.empty()) return;
  const Loudness before = loudness(mel);
  // Loud frames lie about 4 dB above the mean power of speech.
  const double power = before.power - (snr_db + 4) * kNepersPerDb;
  // Spectrum: a tilt and three slow cosines over the bands. It wavers from frame to frame as the energy of
  // few samples of noise does, and in half of the cases as a whole too, as voices and machines do.
  std::array<float, kBands> spectrum;
  const double tilt = rng.uniform(-4.0, 1.0);
  std::array<double, 3> wave, phase;
  for (std::size_t i = 0; i < wave.size(); ++i) {
    wave[i] = rng.normal(0, 0.6);
    phase[i] = rng.uniform(0, 2 * std::numbers::pi);
  }
  for (std::size_t b = 0; b < kBands; ++b) {
    const double x = static_cast<double>(b) / (kBands - 1);
    double value = power + tilt * (x - 0.5);
    for (std::size_t i = 0; i < wave.size(); ++i)
      value += wave[i] * std::cos(std::numbers::pi * static_cast<double>(i + 1) * x + phase[i]);
    spectrum[b] = static_cast<float>(value);
  }
  const double swell = rng.chance(0.5) ? rng.uniform(0.2, 1.2) : 0.0, slowness = rng.uniform(0.8, 0.98);
  double level = 0;
  for (std::size_t t = 0; t < num_frames(mel); ++t) {
    level = slowness * level + std::sqrt(1 - slowness * slowness) * rng.normal(0, swell);
    float* row = mel.data() + t * kBands;
    for (std::size_t b = 0; b < kBands; ++b) {
      const auto waver = static_cast<float>(rng.normal(0, 0.5) + level);
      row[b] = log_sum(row[b], spectrum[b] + waver);
    }
  }
  const auto rise = static_cast<float>(loudness(mel).level - before.level);
  for (float& v : mel) v -= rise;
}

void augment_mel(std::span<float> mel, double level_offset_sd_db, Rng& rng) {
  if (mel.empty()) return;
  const double warp = rng.chance(0.6) ? rng.uniform(0.88, 1.14) : 1.0;
  const auto level = static_cast<float>(rng.normal(0, level_offset_sd_db) * kNepersPerDb);
  std::array<float, kBands> offset;
  for (float& o : offset) o = static_cast<float>(rng.normal(0, 0.15));
  warp_bands(mel, warp, offset);
  if (rng.chance(0.35)) add_reverberation(mel, rng.uniform(0.1, 0.8), rng.uniform(0.02, 0.5));
  if (rng.chance(0.5)) add_noise(mel, rng.uniform(2, 30), rng);
  for (float& v : mel) v += level;
  mask(mel, rng);
}

}  // namespace mien::train
