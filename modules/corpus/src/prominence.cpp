#include "mien/corpus/prominence.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "mien/core/audio_clip.h"

namespace mien {
namespace {

constexpr double kGainPerDb = 0.025, kMinGain = 0.75, kMaxGain = 1.25;
constexpr double kMaxDurationS = 0.250;
constexpr double kLevelFloorDb = 1.5, kPitchFloorSt = 0.5, kDurationFloorS = 0.015;  // added to the spreads
constexpr double kLevelWeight = 0.45, kPitchWeight = 0.45, kDurationWeight = 0.30;
constexpr double kAccentScore = 0.35, kAccentReachS = 0.280;
constexpr double kLevelWindowS = 0.025, kLevelHopS = 0.010;
constexpr double kPitchHz = 100;  // frames per second of track_pitch

struct Vowel {
  std::size_t phone;
  double time_s;    // its middle
  double level_db;  // over the middle 60 %
  double peak_db;
  double seconds;
  std::optional<double> pitch_st;  // highest, semitones
};

double rms_db(std::span<const float> samples, double start_s, double end_s) {
  const auto size = static_cast<double>(samples.size());
  const auto first = static_cast<std::size_t>(std::clamp(start_s * kModelSampleRateHz, 0.0, size));
  const auto last = static_cast<std::size_t>(std::clamp(end_s * kModelSampleRateHz, 0.0, size));
  double sum = 0;
  for (std::size_t i = first; i < last; ++i) sum += double(samples[i]) * samples[i];
  const double power = last > first ? sum / static_cast<double>(last - first) : 0;
  return 10 * std::log10(power + 1e-10);
}

double peak_level_db(std::span<const float> samples, double start_s, double end_s) {
  double peak = rms_db(samples, start_s, std::min(end_s, start_s + kLevelWindowS));
  for (double t = start_s + kLevelHopS; t + kLevelWindowS <= end_s; t += kLevelHopS)
    peak = std::max(peak, rms_db(samples, t, t + kLevelWindowS));
  return peak;
}

std::optional<double> highest_pitch_st(const std::vector<float>& track, double start_s, double end_s) {
  float highest = 0;
  const auto last = std::min(static_cast<double>(track.size()) - 1, std::floor(end_s * kPitchHz));
  for (double t = std::max(0.0, std::ceil(start_s * kPitchHz)); t <= last; ++t)
    highest = std::max(highest, track[static_cast<std::size_t>(t)]);
  if (highest <= 0) return std::nullopt;
  return 12 * std::log2(highest / 100.0);
}

// Vowels that lie in the sound.
std::vector<Vowel> measure_vowels(const Utterance& utterance, std::span<const float> samples) {
  const std::vector<float> pitch = track_pitch(samples);
  const double seconds = static_cast<double>(samples.size()) / kModelSampleRateHz;
  std::vector<Vowel> vowels;
  for (std::size_t p = 0; p < utterance.phones.size(); ++p) {
    const PhoneSegment& phone = utterance.phones[p];
    const bool has_vowel =
        is_vowel(phone.visemes.first) || (phone.visemes.second && is_vowel(*phone.visemes.second));
    const double d = phone.seconds();
    if (!has_vowel || !(d > 0) || !(phone.start_s >= 0) || !(phone.end_s <= seconds + 0.01)) continue;
    vowels.push_back({.phone = p,
                      .time_s = (phone.start_s + phone.end_s) / 2,
                      .level_db = rms_db(samples, phone.start_s + 0.2 * d, phone.end_s - 0.2 * d),
                      .peak_db = peak_level_db(samples, phone.start_s, phone.end_s),
                      .seconds = std::min(d, kMaxDurationS),
                      .pitch_st = highest_pitch_st(pitch, phone.start_s, phone.end_s)});
  }
  return vowels;
}

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return (*middle + *std::max_element(values.begin(), middle)) / 2;
}

// Removes the straight line through the voiced vowels: pitch falls over a sentence.
void remove_declination(std::vector<Vowel>& vowels) {
  double n = 0, t = 0, y = 0, tt = 0, ty = 0;
  for (const Vowel& v : vowels) {
    if (!v.pitch_st) continue;
    n += 1, t += v.time_s, y += *v.pitch_st, tt += v.time_s * v.time_s, ty += v.time_s * *v.pitch_st;
  }
  const double spread = n * tt - t * t;
  const double slope = spread > 1e-9 ? (n * ty - t * y) / spread : 0;
  for (Vowel& v : vowels)
    if (v.pitch_st) *v.pitch_st -= slope * v.time_s;
}

// (value - mean) / (sd + floor); a value that is missing scores 0.
std::vector<double> z_scores(const std::vector<std::optional<double>>& values, double floor) {
  double n = 0, sum = 0, squares = 0;
  for (const auto& v : values)
    if (v) n += 1, sum += *v;
  const double mean = n > 0 ? sum / n : 0;
  for (const auto& v : values)
    if (v) squares += (*v - mean) * (*v - mean);
  const double sd = n > 0 ? std::sqrt(squares / n) : 0;
  std::vector<double> z;
  for (const auto& v : values) z.push_back(v ? (*v - mean) / (sd + floor) : 0);
  return z;
}

std::vector<double> accent_scores(const std::vector<Vowel>& vowels) {
  std::vector<std::optional<double>> level, pitch, duration;
  for (const Vowel& v : vowels) {
    level.push_back(v.peak_db);
    pitch.push_back(v.pitch_st);
    duration.push_back(v.seconds);
  }
  const auto level_z = z_scores(level, kLevelFloorDb), pitch_z = z_scores(pitch, kPitchFloorSt);
  const auto duration_z = z_scores(duration, kDurationFloorS);
  std::vector<double> scores;
  for (std::size_t i = 0; i < vowels.size(); ++i)
    scores.push_back(kLevelWeight * level_z[i] + kPitchWeight * pitch_z[i] + kDurationWeight * duration_z[i]);
  return scores;
}

}  // namespace

void add_prominence(Utterance& utterance, std::span<const float> samples_16k) {
  for (PhoneSegment& phone : utterance.phones) phone.prominence = 1;
  utterance.accents_s.clear();
  std::vector<Vowel> vowels = measure_vowels(utterance, samples_16k);
  if (vowels.empty()) return;

  std::vector<double> levels;
  for (const Vowel& v : vowels) levels.push_back(v.level_db);
  const double median = median_of(levels);
  for (const Vowel& v : vowels)
    utterance.phones[v.phone].prominence =
        std::clamp(1 + kGainPerDb * (v.level_db - median), kMinGain, kMaxGain);

  remove_declination(vowels);
  const std::vector<double> scores = accent_scores(vowels);
  for (std::size_t i = 0; i < vowels.size(); ++i) {
    bool is_accent = scores[i] > kAccentScore;
    for (std::size_t k = 0; k < vowels.size(); ++k)
      if (k != i && std::abs(vowels[k].time_s - vowels[i].time_s) <= kAccentReachS && scores[k] > scores[i])
        is_accent = false;
    if (is_accent) utterance.accents_s.push_back(vowels[i].time_s);
  }
}

}  // namespace mien
