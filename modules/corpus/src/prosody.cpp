#include "mien/corpus/prosody.h"

namespace mien {

Prosody prosody_of(Emotion emotion, double intensity) {
  static constexpr std::array<Prosody, kNumEmotions> kAtFull = {{
      {},                           // neutral
      {12, 1.35, 6, 1, 1.5, 0},     // happy
      {-10, 0.55, -16, -3, -4, 0},  // sad
      {22, 1.60, 5, 1, 1, 0},       // surprised
      {18, 0.90, 14, -1, -1, 2},    // fear
      {-6, 0.90, -10, 0, -1, 0},    // disgusted
      {4, 1.25, 8, 3, 4, 0},        // angry
      {-5, 0.80, -10, -1, -1, 0},   // contempt
  }};
  Prosody p = kAtFull[static_cast<std::size_t>(emotion)];
  p.pitch_percent *= intensity;
  p.pitch_range = scaled_gain(p.pitch_range, intensity);
  p.rate_percent *= intensity;
  p.level_db *= intensity;
  p.tilt_db *= intensity;
  p.tremor_percent *= intensity;
  return p;
}

}  // namespace mien
