#include "mien/metrics/lip_lag.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "mien/base/random.h"
#include "mien/metrics/loudness.h"

namespace mien {
namespace {

constexpr int kSeconds = 6;

// Bursts of noise, between -6 dB and -60 dB, that come at uneven times.
double loudness_at(double seconds) {
  const double phase =
      std::sin(2 * 3.1 * seconds) + std::sin(2 * 5.3 * seconds + 1) + std::sin(2 * 9.7 * seconds);
  return 1 / (1 + std::exp(-2 * phase));
}

std::vector<double> speech() {
  std::vector<float> samples(16000 * kSeconds);
  NoiseField(3, 0).normal(0, 0, samples);
  for (std::size_t i = 0; i < samples.size(); ++i)
    samples[i] *=
        static_cast<float>(0.2 * std::pow(10, 1.5 * (loudness_at(static_cast<double>(i) / 16000) - 1)));
  return speech_level_db(samples);
}

// Lips that open as it is loud, `late` seconds later.
std::vector<double> lips(double late) {
  std::vector<double> aperture;
  for (int n = 0; n < 60 * kSeconds; ++n) aperture.push_back(0.3 * loudness_at(n / 60.0 - late));
  return aperture;
}

TEST(LipLag, FindsHowFarCopiesWereShifted) {
  for (const double late_ms : {0.0, 50.0, -50.0, 100.0, 25.0, -208.0, 400.0}) {
    const LipLag lag = lip_lag(lips(late_ms / 1000), speech());
    EXPECT_NEAR(lag.lag_ms, late_ms, 6) << late_ms;
    EXPECT_GT(lag.peak_r, 0.9);
    EXPECT_GT(lag.confidence, 0.5);
  }
}

TEST(LipLag, IsNotSureOfLipsThatDoSomethingElse) {
  std::vector<double> other = lips(0);
  NoiseField noise(9, 0);
  for (std::size_t n = 0; n < other.size(); ++n) other[n] = noise.uniform(n, 0);
  EXPECT_LT(lip_lag(other, speech()).confidence, 0.35);
}

TEST(LipLag, IsNotDefinedForStillLipsSilenceOrShortClips) {
  EXPECT_TRUE(std::isnan(lip_lag(std::vector<double>(360, 0.2), speech()).lag_ms));
  EXPECT_TRUE(std::isnan(lip_lag(lips(0), speech_level_db(std::vector<float>(96000, 0.0f))).confidence));
  EXPECT_TRUE(std::isnan(lip_lag(std::vector<double>(119, 0.2), std::vector<double>(119, 0)).peak_r));
  EXPECT_TRUE(std::isnan(lip_lag({}, {}).lag_ms));
}

}  // namespace
}  // namespace mien
