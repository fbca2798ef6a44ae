#pragma once
#include <cstdint>
#include <span>
#include <vector>

namespace mien {

/// Mean [K] and covariance [K, K], over their number, of runs of K samples.
struct PatchStatistics {
  std::vector<double> mean, covariance;
};

/// Adds up the runs of `kernel` samples that begin every `stride` samples: what a convolution sees. Sums are
/// of differences to the first sample, in double, so that an offset costs no precision; the cut of the input
/// changes no bit.
class PatchSums {
 public:
  /// @pre both at least 1
  PatchSums(std::int64_t kernel, std::int64_t stride);
  void add(std::span<const float> samples);
  [[nodiscard]] std::int64_t num_samples() const { return num_samples_; }
  /// @pre num_samples() >= kernel
  [[nodiscard]] PatchStatistics statistics() const;

 private:
  std::size_t kernel_, stride_;
  std::int64_t num_samples_ = 0, num_patches_ = 0;
  double first_ = 0;
  std::size_t to_skip_ = 0;      ///< samples before the next run, when the stride is the longer
  std::vector<double> waiting_;  ///< samples of runs that are not complete
  std::vector<double> sum_, products_;
};

/// y = (x - mean) * scale.
struct WaveformScale {
  double mean = 0, scale = 1;
  float operator()(float x) const { return static_cast<float>((x - mean) * scale); }
};

/// What an encoder must know of the whole of a recording before it can use any part.
struct SpeechStatistics {
  PatchSums samples{1, 1};
  PatchSums patches;  ///< of the first convolution, for its norm over time

  void add(std::span<const float> piece) {
    samples.add(piece);
    patches.add(piece);
  }
  /// To mean 0 and variance 1: 1 / sqrt(variance + eps), population variance. @pre at least one sample
  [[nodiscard]] WaveformScale normalisation(double eps) const;
  /// Of the scaled samples.
  [[nodiscard]] PatchStatistics scaled_patches(const WaveformScale& scale) const;
};

/// In place, over the whole clip. Silence stays silence.
void normalise_waveform(std::span<float> samples, double eps);

}  // namespace mien
