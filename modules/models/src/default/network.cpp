#include "mien/models/default/network.h"

#include <algorithm>
#include <cmath>

namespace mien::default_model {

std::array<float, kNumTimeFeatures> time_features(double half_log_snr) {
  constexpr double kLowest = 0.05, kHighest = 3.0;  // radians per unit of half log-SNR, which spans about +-6
  const double clamped = std::clamp(half_log_snr, -8.0, 8.0);
  std::array<float, kNumTimeFeatures> out{};
  for (std::size_t i = 0; i < out.size() / 2; ++i) {
    const double position = static_cast<double>(i) / static_cast<double>(out.size() / 2 - 1);
    const double frequency = kLowest * std::pow(kHighest / kLowest, position);
    out[i] = static_cast<float>(std::sin(frequency * clamped));
    out[i + out.size() / 2] = static_cast<float>(std::cos(frequency * clamped));
  }
  return out;
}

}  // namespace mien::default_model
