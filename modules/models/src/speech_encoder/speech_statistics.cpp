#include "mien/models/speech_encoder/speech_statistics.h"

#include <algorithm>
#include <cmath>

#include "mien/base/contract.h"

namespace mien {

PatchSums::PatchSums(std::int64_t kernel, std::int64_t stride)
    : kernel_(static_cast<std::size_t>(kernel)),
      stride_(static_cast<std::size_t>(stride)),
      sum_(kernel_),
      products_(kernel_ * kernel_) {
  contract(kernel >= 1 && stride >= 1, "PatchSums: kernel and stride must be at least 1");
}

void PatchSums::add(std::span<const float> samples) {
  if (samples.empty()) return;
  if (num_samples_ == 0) first_ = samples.front();
  num_samples_ += static_cast<std::int64_t>(samples.size());
  const std::size_t skipped = std::min(to_skip_, samples.size());
  to_skip_ -= skipped;
  for (const float x : samples.subspan(skipped)) waiting_.push_back(x - first_);
  std::size_t at = 0;
  for (; at + kernel_ <= waiting_.size(); at += stride_, ++num_patches_) {
    const double* x = waiting_.data() + at;
    for (std::size_t j = 0; j < kernel_; ++j) {
      sum_[j] += x[j];
      for (std::size_t k = 0; k <= j; ++k) products_[j * kernel_ + k] += x[j] * x[k];
    }
  }
  const std::size_t used = std::min(at, waiting_.size());
  to_skip_ += at - used;
  waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(used));
}

PatchStatistics PatchSums::statistics() const {
  contract(num_patches_ > 0, "PatchSums: fewer samples than the kernel");
  const auto count = static_cast<double>(num_patches_);
  PatchStatistics s{std::vector<double>(kernel_), std::vector<double>(kernel_ * kernel_)};
  for (std::size_t j = 0; j < kernel_; ++j) {
    s.mean[j] = first_ + sum_[j] / count;
    for (std::size_t k = 0; k <= j; ++k)
      s.covariance[j * kernel_ + k] = s.covariance[k * kernel_ + j] =
          products_[j * kernel_ + k] / count - (sum_[j] / count) * (sum_[k] / count);
  }
  return s;
}

WaveformScale SpeechStatistics::normalisation(double eps) const {
  const PatchStatistics s = samples.statistics();
  return {s.mean[0], 1.0 / std::sqrt(std::max(s.covariance[0], 0.0) + eps)};
}

PatchStatistics SpeechStatistics::scaled_patches(const WaveformScale& scale) const {
  PatchStatistics s = patches.statistics();
  for (double& m : s.mean) m = (m - scale.mean) * scale.scale;
  for (double& c : s.covariance) c *= scale.scale * scale.scale;
  return s;
}

void normalise_waveform(std::span<float> samples, double eps) {
  if (samples.empty()) return;
  SpeechStatistics statistics{.patches = PatchSums(1, 1)};
  statistics.samples.add(samples);
  const WaveformScale scale = statistics.normalisation(eps);
  for (float& x : samples) x = scale(x);
}

}  // namespace mien
