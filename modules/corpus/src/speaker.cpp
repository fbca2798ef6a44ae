#include "mien/corpus/speaker.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace mien {
namespace {

// Spreads of the log-normal gains and their limits are those of section 6.
double gain(Rng& rng, double sigma, double low, double high, double median = 1) {
  return std::clamp(median * rng.log_normal(0, sigma), low, high);
}
double bounded(Rng& rng, double mean, double sd, double low, double high) {
  return std::clamp(rng.normal(mean, sd), low, high);
}

}  // namespace

std::span<const Speaker, kNumFixedSpeakers> fixed_speakers() {
  // clang-format off
  // id, jaw, lip, round, spread, press, width, lead, asym, restSmile, restBrow, blink, pbrow, abrow, pnod, anod, gazeAway, gazeAmp, headOU, squintTalk, emoGain, mirror
  static const std::array<Speaker, kNumFixedSpeakers> speakers = {{
    {"S00", 0.94, 0.92, 1.40, 1.50, 1.03, 0.87, 0.012, 0.003, 0.004, 0.046, 25.5, 0.10, 0.30, 0.18, 2.11, 0.21, 7.5, 1.10, 0.026, 0.95, false},
    {"S01", 1.18, 0.98, 0.80, 1.30, 0.74, 0.96, 0.011, -0.047, 0.021, 0.020, 18.7, 0.45, 0.21, 0.34, 3.42, 0.40, 12.6, 1.02, 0.060, 0.85, true},
    {"S02", 1.02, 0.75, 1.30, 1.02, 0.79, 1.12, 0.020, -0.102, 0.063, -0.018, 12.8, 0.31, 0.17, 0.17, 2.00, 0.26, 8.9, 0.86, 0.046, 1.05, false},
    {"S03", 0.83, 0.98, 0.75, 0.92, 0.99, 1.15, 0.025, 0.040, 0.047, 0.009, 20.9, 0.21, 0.15, 0.56, 2.62, 0.10, 7.8, 1.26, 0.019, 0.84, true},
    {"S04", 1.00, 0.99, 1.05, 1.01, 1.27, 1.14, 0.010, -0.019, 0.044, -0.032, 19.8, 0.14, 0.26, 0.31, 2.79, 0.25, 8.8, 1.63, 0.050, 0.99, false},
    {"S05", 0.88, 0.97, 0.89, 0.97, 1.23, 0.94, 0.005, 0.138, 0.000, -0.019, 24.1, 0.19, 0.19, 0.14, 1.35, 0.41, 13.6, 1.20, 0.018, 0.79, true},
    {"S06", 1.23, 0.70, 1.19, 1.49, 1.14, 1.15, 0.006, -0.126, 0.019, 0.043, 29.3, 0.21, 0.13, 0.49, 1.93, 0.32, 8.2, 1.13, 0.060, 0.92, false},
    {"S07", 0.82, 0.80, 1.03, 1.20, 1.11, 1.03, -0.003, 0.096, 0.000, -0.021, 14.6, 0.44, 0.27, 0.41, 4.27, 0.45, 10.7, 0.86, 0.058, 0.77, true},
    {"S08", 0.93, 0.84, 1.40, 1.43, 0.62, 1.10, 0.006, -0.021, 0.038, -0.046, 11.0, 0.16, 0.16, 0.13, 3.22, 0.29, 9.8, 1.55, 0.047, 0.82, false},
    {"S09", 1.14, 1.24, 1.15, 0.98, 1.15, 1.12, 0.018, 0.166, 0.018, -0.004, 25.1, 0.31, 0.21, 0.30, 2.48, 0.29, 9.6, 0.67, 0.048, 0.82, true},
    {"S10", 0.74, 1.10, 0.96, 0.79, 1.12, 0.85, 0.014, 0.094, 0.000, 0.006, 16.5, 0.08, 0.23, 0.15, 2.55, 0.47, 10.9, 1.45, 0.091, 0.95, false},
    {"S11", 0.89, 1.08, 0.70, 1.07, 1.36, 1.05, 0.005, 0.158, 0.086, 0.007, 14.5, 0.44, 0.09, 0.44, 2.37, 0.17, 7.2, 1.26, 0.039, 1.25, true},
    {"S12", 0.93, 0.98, 1.38, 0.60, 0.60, 1.05, -0.006, 0.002, 0.089, -0.030, 32.0, 0.11, 0.28, 0.32, 2.49, 0.19, 11.9, 0.69, 0.036, 0.88, false},
    {"S13", 1.13, 0.84, 0.91, 1.45, 1.11, 1.13, 0.013, 0.094, 0.037, -0.026, 9.9, 0.13, 0.14, 0.18, 1.80, 0.21, 6.5, 0.74, 0.080, 1.18, true},
    {"S14", 0.90, 0.87, 1.06, 0.90, 1.04, 0.88, 0.025, 0.016, 0.059, -0.032, 18.6, 0.34, 0.33, 0.32, 2.76, 0.25, 8.1, 0.78, 0.048, 0.89, false},
    {"S15", 0.78, 0.86, 1.06, 1.28, 0.95, 1.01, 0.016, -0.151, 0.000, -0.019, 17.3, 0.24, 0.18, 0.27, 4.00, 0.23, 11.7, 1.05, 0.060, 0.92, true},
  }};
  // clang-format on
  return speakers;
}

const Speaker* find_speaker(std::string_view id) {
  const auto all = fixed_speakers();
  const auto found = std::find_if(all.begin(), all.end(), [&](const Speaker& s) { return s.id == id; });
  return found == all.end() ? nullptr : &*found;
}

Speaker draw_speaker(Rng& rng) {
  Speaker s;
  s.id = "drawn";
  s.jaw = gain(rng, 0.18, 0.65, 1.45);
  s.lip = gain(rng, 0.18, 0.65, 1.45);
  s.round = gain(rng, 0.20, 0.6, 1.4);
  s.spread = gain(rng, 0.22, 0.6, 1.5);
  s.press = gain(rng, 0.20, 0.6, 1.5);
  s.width = bounded(rng, 1, 0.10, 0.8, 1.25);
  s.lead_s = bounded(rng, 0.010, 0.010, -0.010, 0.030);
  s.asymmetry = bounded(rng, 0, 0.07, -0.18, 0.18);
  s.rest_smile = bounded(rng, 0.03, 0.03, 0, 0.1);
  s.rest_brow = bounded(rng, 0, 0.03, -0.06, 0.08);
  s.blinks_per_minute = gain(rng, 0.35, 8, 32, 18);
  s.brow_probability = bounded(rng, 0.24, 0.10, 0.05, 0.5);
  s.brow_amplitude = gain(rng, 0.35, 0.08, 0.5, 0.22);
  s.nod_probability = bounded(rng, 0.35, 0.12, 0.1, 0.65);
  s.nod_deg = gain(rng, 0.3, 1, 5, 2.4);
  s.gaze_away = bounded(rng, 0.30, 0.10, 0.1, 0.55);
  s.gaze_deg = gain(rng, 0.25, 5, 16, 9);
  s.head_deg = gain(rng, 0.3, 0.5, 2.2, 1.1);
  s.squint_talk = bounded(rng, 0.04, 0.03, 0, 0.1);
  s.emotion_gain = gain(rng, 0.15, 0.7, 1.35);
  s.mirror_contempt = rng.chance(0.5);
  return s;
}

}  // namespace mien
