#pragma once
#include <algorithm>
#include <cstddef>
#include <span>

#include "mien/base/result.h"

namespace mien {

/// Mono speech at 16 kHz that can be heard more than once: an encoder needs mean and variance of the whole
/// before it can use any part.
class SampleSource {
 public:
  virtual ~SampleSource() = default;
  /// Back to the first sample. Errors (Errc::input): a file that can no longer be read.
  virtual Status rewind() = 0;
  /// Writes the next samples to `out` and returns their number; fewer than out.size() only at the end, then
  /// 0. Errors (Errc::input).
  virtual Result<std::size_t> read(std::span<float> out) = 0;

 protected:
  SampleSource() = default;
  SampleSource(const SampleSource&) = default;
  SampleSource& operator=(const SampleSource&) = default;
};

/// Samples that are in memory and outlive this.
class SamplesInMemory final : public SampleSource {
 public:
  explicit SamplesInMemory(std::span<const float> samples) : samples_(samples) {}
  Status rewind() override {
    next_ = 0;
    return Done{};
  }
  Result<std::size_t> read(std::span<float> out) override {
    const std::size_t count = std::min(out.size(), samples_.size() - next_);
    std::copy_n(samples_.begin() + static_cast<std::ptrdiff_t>(next_), count, out.begin());
    next_ += count;
    return count;
  }

 private:
  std::span<const float> samples_;
  std::size_t next_ = 0;
};

}  // namespace mien
