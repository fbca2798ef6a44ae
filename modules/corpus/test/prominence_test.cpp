#include "mien/corpus/prominence.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "mien/base/random.h"

namespace mien {
namespace {

// A voice-like tone: eight harmonics.
std::vector<float> voice(double hz, double seconds, double gain = 0.1) {
  std::vector<float> samples(static_cast<std::size_t>(seconds * 16000));
  for (std::size_t i = 0; i < samples.size(); ++i) {
    double value = 0;
    for (int h = 1; h <= 8; ++h)
      value += std::sin(2 * std::numbers::pi * hz * h * static_cast<double>(i) / 16000 + 0.3 * h * h) / h;
    samples[i] = static_cast<float>(gain * value);
  }
  return samples;
}

TEST(Pitch, FindsTheFundamentalOfAVoice) {
  for (const double hz : {70.0, 101.0, 139.0, 220.0, 311.0, 390.0})
    for (const double gain : {0.001, 0.2}) {
      const auto track = track_pitch(voice(hz, 0.5, gain));
      ASSERT_EQ(track.size(), 51u);
      for (std::size_t t = 10; t < 40; ++t)
        EXPECT_NEAR(12 * std::log2(track[t] / hz), 0, 0.15) << hz << " Hz at frame " << t;
    }
}

TEST(Pitch, SilenceAndNoiseAreUnvoiced) {
  for (const float hz : track_pitch(std::vector<float>(8000))) EXPECT_EQ(hz, 0);
  Rng rng(1);
  std::vector<float> noise(32000);
  for (float& v : noise) v = static_cast<float>(rng.normal(0, 0.1));
  int voiced = 0;
  for (const float hz : track_pitch(noise)) voiced += hz > 0;
  EXPECT_LT(voiced, 10);
  EXPECT_EQ(track_pitch({}).size(), 1u);
  EXPECT_EQ(track_pitch(std::vector<float>{1.0f}).size(), 1u);
}

// Twelve vowels of 0.12 s, 0.3 s apart, with given pitch and level.
struct Tune {
  Utterance utterance;
  std::vector<float> samples;
};
Tune tune(const std::vector<double>& hz, const std::vector<double>& gain) {
  Tune out;
  out.samples.resize(static_cast<std::size_t>(16000 * 0.3 * static_cast<double>(hz.size())));
  for (std::size_t i = 0; i < hz.size(); ++i) {
    const double start = 0.3 * static_cast<double>(i) + 0.05;
    const auto sound = voice(hz[i], 0.12, gain[i]);
    std::copy(sound.begin(), sound.end(), out.samples.begin() + static_cast<std::ptrdiff_t>(start * 16000));
    out.utterance.phones.push_back(
        {.start_s = start, .end_s = start + 0.12, .label = "aa", .visemes = {Viseme::AA}});
    out.utterance.phones.push_back(
        {.start_s = start + 0.12, .end_s = start + 0.3, .label = "s", .visemes = {Viseme::SS}});
  }
  out.utterance.seconds = 0.3 * static_cast<double>(hz.size());
  return out;
}

TEST(Prominence, LouderVowelsOpenMore) {
  Tune t = tune(std::vector<double>(5, 120), {0.1, 0.1, 0.2, 0.1, 0.05});
  add_prominence(t.utterance, t.samples);
  EXPECT_NEAR(t.utterance.phones[0].prominence, 1, 1e-3);
  EXPECT_NEAR(t.utterance.phones[4].prominence, 1 + 0.025 * 6.02, 1e-2);
  EXPECT_NEAR(t.utterance.phones[8].prominence, 1 - 0.025 * 6.02, 1e-2);
  EXPECT_EQ(t.utterance.phones[1].prominence, 1) << "consonants keep 1";
}

TEST(Prominence, AccentsAreHighLoudVowelsOnAFallingLine) {
  std::vector<double> hz, gain(12, 0.1);
  for (int i = 0; i < 12; ++i)
    hz.push_back(160 * std::pow(2, -i / 24.0));  // half a semitone down for each vowel
  hz[8] *= 1.35;
  gain[3] = 0.35;
  Tune t = tune(hz, gain);
  add_prominence(t.utterance, t.samples);
  ASSERT_EQ(t.utterance.accents_s.size(), 2u);
  EXPECT_NEAR(t.utterance.accents_s[0], 0.3 * 3 + 0.11, 1e-9);
  EXPECT_NEAR(t.utterance.accents_s[1], 0.3 * 8 + 0.11, 1e-9);
}

TEST(Prominence, DegenerateInput) {
  Utterance empty;
  add_prominence(empty, {});
  EXPECT_TRUE(empty.accents_s.empty());
  Tune t = tune(std::vector<double>(4, 120), std::vector<double>(4, 0.1));
  add_prominence(t.utterance, {});  // no sound under the phones
  EXPECT_EQ(t.utterance.phones[0].prominence, 1);
  add_prominence(t.utterance, std::vector<float>(t.samples.size()));  // silence
  EXPECT_EQ(t.utterance.phones[0].prominence, 1);
  EXPECT_TRUE(t.utterance.accents_s.empty());
  Tune one = tune({120}, {0.1});
  add_prominence(one.utterance, one.samples);
  EXPECT_EQ(one.utterance.phones[0].prominence, 1);
}

}  // namespace
}  // namespace mien
