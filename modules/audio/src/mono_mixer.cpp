#include "mono_mixer.h"

#include <cmath>

#include "mien/base/number_text.h"

namespace mien {
namespace {

// 120 dB above full scale: beyond every real recording, and its power spectrum is still far from overflow.
constexpr float kLargestSample = 1e6f;
constexpr double kSilentRms = 1e-5;        // -100 dB
constexpr double kCancelledEnergy = 1e-4;  // mean of the channels 40 dB below them
constexpr double kClippedShare = 0.005;

}  // namespace

std::optional<std::string> MonoMixer::mix(const SoundBlock& block, std::vector<float>& mono) {
  const int channels = block.num_channels;
  const std::int64_t num_frames = block.num_frames();
  mono.resize(static_cast<std::size_t>(num_frames));
  double mono_energy = 0, channel_energy = 0;
  const float* x = block.samples.data();
  for (std::int64_t i = 0; i < num_frames; ++i) {
    float sum = 0;
    for (int c = 0; c < channels; ++c, ++x) {
      const float size = std::fabs(*x);
      if (!(size <= kLargestSample)) {  // also true for NaN
        const std::int64_t position = num_frames_ + i;
        std::string why = "sample " + std::to_string(position) + " (" +
                          fixed(static_cast<double>(position) / sample_rate_hz_, 3) + " s)";
        if (channels > 1) why += " of channel " + std::to_string(c + 1);
        why += std::isnan(*x) ? " is NaN" : std::isinf(*x) ? " is infinite" : " is " + shortest(*x);
        return why + ", expected a number near -1 ... 1";
      }
      num_at_limit_ += size >= 0.9999f && size <= 1.0f ? 1 : 0;
      sum += *x;
      channel_energy += static_cast<double>(*x) * *x;
    }
    const float mean = sum / static_cast<float>(channels);
    mono[static_cast<std::size_t>(i)] = mean;
    mono_energy += static_cast<double>(mean) * mean;
  }
  num_frames_ += num_frames;
  num_samples_ += num_frames * channels;
  mono_energy_ += mono_energy;
  channel_energy_ += channels > 0 ? channel_energy / channels : 0.0;
  return std::nullopt;
}

std::vector<std::string> MonoMixer::verdict() const {
  std::vector<std::string> warnings;
  if (num_frames_ == 0) return warnings;
  const double channel_rms = std::sqrt(channel_energy_ / static_cast<double>(num_frames_));
  if (channel_rms < kSilentRms) {
    warnings.emplace_back("the recording is silent");
  } else if (mono_energy_ < kCancelledEnergy * channel_energy_) {
    warnings.emplace_back(
        "the channels cancel each other (one is the other upside down), so their mean is silent; invert one "
        "of them");
  }
  const double share = static_cast<double>(num_at_limit_) / static_cast<double>(num_samples_);
  if (share > kClippedShare)
    warnings.push_back("clipped: " + fixed(100.0 * share, 1) + " % of the samples are at full scale");
  return warnings;
}

}  // namespace mien
