#include <cmath>

#include "mien/models/speech_encoder/network.h"

namespace mien {

void normalise_waveform(std::span<float> samples, double eps) {
  if (samples.empty()) return;
  const auto count = static_cast<double>(samples.size());
  double sum = 0, squares = 0;
  for (const float x : samples) sum += x;
  const double mean = sum / count;
  for (const float x : samples) squares += (x - mean) * (x - mean);
  const double scale = 1.0 / std::sqrt(squares / count + eps);
  for (float& x : samples) x = static_cast<float>((x - mean) * scale);
}

}  // namespace mien
