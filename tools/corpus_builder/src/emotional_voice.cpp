#include "emotional_voice.h"

#include <cmath>

#include "filters.h"
#include "mien/corpus/prosody.h"

namespace mien {
namespace {
constexpr double kTiltHz = 1500, kTremorHz = 5;
}

Speaking with_emotion(Speaking s, Emotion emotion, double intensity) {
  const auto p = prosody_of(emotion, intensity);
  s.pitch_percent += p.pitch_percent;
  s.range *= p.pitch_range;
  s.rate *= 1 + p.rate_percent / 100;
  return s;
}

void color_with_emotion(std::vector<float>& samples, Emotion emotion, double intensity) {
  const auto p = prosody_of(emotion, intensity);
  if (p.tremor_percent > 0) samples = tremor(samples, kTremorHz, p.tremor_percent / 100);
  high_shelf(samples, kTiltHz, p.tilt_db);
  const auto gain = static_cast<float>(std::pow(10.0, p.level_db / 20));
  for (auto& v : samples) v *= gain;
}

}  // namespace mien
