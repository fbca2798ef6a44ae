// In place of resampler.cpp where soxr is absent: sound at the right rate passes.
#include "mien/base/contract.h"
#include "mien/core/audio_clip.h"
#include "resampler.h"

namespace mien {

struct Resampler::State {};

bool Resampler::takes(int input_rate_hz) { return input_rate_hz == kModelSampleRateHz; }

Resampler::Resampler(int input_rate_hz) { contract(takes(input_rate_hz), "Resampler: this rate needs soxr"); }
Resampler::Resampler(Resampler&&) noexcept = default;
Resampler& Resampler::operator=(Resampler&&) noexcept = default;
Resampler::~Resampler() = default;

void Resampler::push(std::span<const float> in, std::vector<float>& out) {
  out.insert(out.end(), in.begin(), in.end());
}
void Resampler::finish(std::vector<float>&) {}

}  // namespace mien
