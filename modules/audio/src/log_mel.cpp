#include "mien/audio/log_mel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "fft512.h"
#include "mien/base/contract.h"
#include "mien/core/audio_clip.h"

namespace mien {
namespace {

constexpr double kLowestHz = 60.0;
constexpr double kHighestHz = 7600.0;
constexpr float kEnergyFloor = 1e-7f;  // corpus specification, section 14: ln(e + 1e-7)
constexpr int kHalfWindow = kMelWindow / 2;

double hz_to_mel(double hz) { return 2595.0 * std::log10(1.0 + hz / 700.0); }
double mel_to_hz(double mel) { return 700.0 * (std::pow(10.0, mel / 2595.0) - 1.0); }

/// Everything that does not depend on the sound.
class MelFrames {
 public:
  MelFrames() {
    for (int n = 0; n < kMelWindow; ++n)
      window_[n] = static_cast<float>(0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * n / kMelWindow));
    const double low = hz_to_mel(kLowestHz);
    const double step = (hz_to_mel(kHighestHz) - low) / (kNumMelBands + 1);
    for (int b = 0; b < kNumMelBands; ++b)
      add_band(mel_to_hz(low + b * step), mel_to_hz(low + (b + 1) * step), mel_to_hz(low + (b + 2) * step));
  }

  void compute(std::span<const float, kMelWindow> samples, std::span<float, kNumMelBands> out) const {
    std::array<float, Fft512::kSize> windowed{};
    for (int n = 0; n < kMelWindow; ++n) windowed[n] = samples[n] * window_[n];
    std::array<float, Fft512::kNumBins> power;
    fft_.power(windowed, power);
    const float* weight = weights_.data();
    for (int b = 0; b < kNumMelBands; ++b) {
      float energy = 0.0f;
      for (int k = bands_[b].first_bin; k < bands_[b].end_bin; ++k) energy += *weight++ * power[k];
      out[b] = std::log(energy + kEnergyFloor);
    }
  }

 private:
  void add_band(double left_hz, double centre_hz, double right_hz) {
    Band band{.first_bin = Fft512::kNumBins, .end_bin = 0};
    std::vector<double> triangle;
    for (int k = 0; k < Fft512::kNumBins; ++k) {
      const double hz = static_cast<double>(k) * kModelSampleRateHz / Fft512::kSize;
      const double w =
          std::min((hz - left_hz) / (centre_hz - left_hz), (right_hz - hz) / (right_hz - centre_hz));
      if (w <= 0.0) continue;
      band.first_bin = std::min(band.first_bin, k);
      band.end_bin = k + 1;
      triangle.push_back(w);
    }
    contract(!triangle.empty(), "log_mel: a mel band without a frequency bin");
    double sum = 0.0;
    for (const double w : triangle) sum += w;
    for (const double w : triangle) weights_.push_back(static_cast<float>(w / sum));
    bands_[num_bands_++] = band;
  }

  struct Band {
    int first_bin, end_bin;
  };
  Fft512 fft_;
  std::array<float, kMelWindow> window_;
  std::array<Band, kNumMelBands> bands_;
  std::vector<float> weights_;  // of all bands, one after the other
  int num_bands_ = 0;
};

const MelFrames& mel_frames() {
  static const MelFrames frames;
  return frames;
}

}  // namespace

Features log_mel(std::span<const float> samples_16k) {
  const MelFrames& frames = mel_frames();
  const auto num_samples = static_cast<std::int64_t>(samples_16k.size());
  const std::int64_t num_frames = num_mel_frames(num_samples);
  Features features{.values = std::vector<float>(static_cast<std::size_t>(num_frames * kNumMelBands)),
                    .width = kNumMelBands,
                    .frame_rate_hz = kMelFrameRateHz};
  std::array<float, kMelWindow> padded;
  for (std::int64_t t = 0; t < num_frames; ++t) {
    const std::int64_t start = t * kMelHop - kHalfWindow;
    const float* window = padded.data();
    if (start >= 0 && start + kMelWindow <= num_samples) {
      window = samples_16k.data() + start;
    } else {
      for (std::int64_t n = 0; n < kMelWindow; ++n)
        padded[n] = start + n >= 0 && start + n < num_samples ? samples_16k[start + n] : 0.0f;
    }
    frames.compute(std::span<const float, kMelWindow>(window, kMelWindow),
                   std::span<float, kNumMelBands>(features.values.data() + t * kNumMelBands, kNumMelBands));
  }
  return features;
}

LogMelStream::LogMelStream() : pending_(kHalfWindow, 0.0f) {}

void LogMelStream::push(std::span<const float> samples_16k) {
  contract(!finished_, "LogMelStream::push after finish");
  // Drop what no frame needs any more before growing; moving only when it is at least half keeps the cost
  // linear.
  if (first_ >= pending_.size() - first_) {
    pending_.erase(pending_.begin(), pending_.begin() + static_cast<std::ptrdiff_t>(first_));
    first_ = 0;
  }
  pending_.insert(pending_.end(), samples_16k.begin(), samples_16k.end());
  num_pushed_ += static_cast<std::int64_t>(samples_16k.size());
}

void LogMelStream::finish() {
  if (finished_) return;
  finished_ = true;
  pending_.insert(pending_.end(), kHalfWindow, 0.0f);
}

bool LogMelStream::pop(std::span<float, kNumMelBands> frame) {
  if (pending_.size() - first_ < kMelWindow) return false;
  mel_frames().compute(std::span<const float, kMelWindow>(pending_.data() + first_, kMelWindow), frame);
  first_ += kMelHop;
  ++num_popped_;
  return true;
}

}  // namespace mien
