#include "mien/audio/log_mel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstring>
#include <numbers>
#include <vector>

#include "fft512.h"
#include "test_sound.h"

namespace mien {
namespace {

constexpr double kPi = std::numbers::pi;

// |X[k]|^2 of up to 512 samples by the definition of the transform.
double power_by_definition(std::span<const double> samples, int k) {
  std::complex<double> sum = 0;
  for (std::size_t n = 0; n < samples.size(); ++n)
    sum += samples[n] * std::polar(1.0, -2.0 * kPi * static_cast<double>((k * n) % 512) / 512.0);
  return std::norm(sum);
}

// One frame of section 14 of the corpus specification, in double and without any shared table.
std::vector<double> frame_by_definition(const std::vector<float>& samples, std::int64_t t) {
  std::vector<double> windowed(400);
  for (int n = 0; n < 400; ++n) {
    const std::int64_t i = 160 * t - 200 + n;
    if (i >= 0 && i < static_cast<std::int64_t>(samples.size()))
      windowed[n] = samples[i] * std::pow(std::sin(kPi * n / 400.0), 2);
  }
  std::vector<double> power(257);
  for (int k = 0; k <= 256; ++k) power[k] = power_by_definition(windowed, k);
  const auto edge_hz = [](int i) {
    const auto mel = [](double hz) { return 2595.0 * std::log10(1.0 + hz / 700.0); };
    return 700.0 * (std::pow(10.0, (mel(60) + i * (mel(7600) - mel(60)) / 65.0) / 2595.0) - 1.0);
  };
  std::vector<double> bands(kNumMelBands);
  for (int b = 0; b < kNumMelBands; ++b) {
    const double left = edge_hz(b), centre = edge_hz(b + 1), right = edge_hz(b + 2);
    double sum = 0, energy = 0;
    for (int k = 0; k <= 256; ++k) {
      const double hz = k * 31.25;
      if (hz <= left || hz >= right) continue;
      const double w = hz < centre ? (hz - left) / (centre - left) : (right - hz) / (right - centre);
      sum += w;
      energy += w * power[k];
    }
    bands[b] = std::log(energy / sum + 1e-7);
  }
  return bands;
}

TEST(Fft512, EqualsTheDefinition) {
  const auto noise = babble(512, 3);
  std::vector<float> samples(noise.begin(), noise.end());
  samples[5] += 1.0f;
  const std::vector<double> exact(samples.begin(), samples.end());
  std::array<float, Fft512::kNumBins> power;
  Fft512().power(std::span<const float, 512>(samples.data(), 512), power);
  for (int k = 0; k <= 256; ++k) {
    const double want = power_by_definition(exact, k);
    EXPECT_NEAR(power[k], want, 1e-5 * (want + 1.0)) << "bin " << k;
  }
}

TEST(LogMel, EqualsTheSpecification) {
  const auto samples = babble(4321);
  const Features got = log_mel(samples);
  ASSERT_EQ(got.num_frames(), 4321 / 160 + 1);
  ASSERT_EQ(got.width, 64);
  EXPECT_EQ(got.frame_rate_hz, 100.0);
  for (std::int64_t t = 0; t < got.num_frames(); ++t) {
    const auto want = frame_by_definition(samples, t);
    for (int b = 0; b < kNumMelBands; ++b)
      ASSERT_NEAR(got.frame(t)[b], want[b], 2e-4) << "frame " << t << " band " << b;  // measured: 1.3e-5
  }
}

TEST(LogMel, ToneLandsInTheBandOfItsFrequency) {
  std::vector<float> samples(1600);
  for (int i = 0; i < 1600; ++i)
    samples[i] = 0.5f * static_cast<float>(std::sin(2.0 * kPi * 1000.0 * i / 16000.0));
  const Features got = log_mel(samples);
  const auto middle = got.frame(5);
  // 1000 Hz = 999.99 mel; bands are 41.47 mel apart, the first centre is at 132.4 mel.
  EXPECT_EQ(std::max_element(middle.begin(), middle.end()) - middle.begin(), 21);
}

TEST(LogMel, SilenceAndNothingGiveTheEnergyFloor) {
  for (const std::size_t n : {0u, 1u, 159u, 160u, 400u, 16000u}) {
    const Features got = log_mel(std::vector<float>(n, 0.0f));
    ASSERT_EQ(got.num_frames(), static_cast<std::int64_t>(n / 160 + 1));
    for (const float x : got.values) ASSERT_FLOAT_EQ(x, std::log(1e-7f));
  }
}

TEST(LogMelStream, EqualsOfflineForAnyChunking) {
  for (const std::size_t n : {0u, 1u, 199u, 200u, 320u, 399u, 5000u}) {
    const auto samples = babble(n, n + 1);
    const Features whole = log_mel(samples);
    for (const std::size_t chunk : {1u, 7u, 160u, 320u, 1024u, 6000u}) {
      for (const bool pop_at_the_end : {false, true}) {
        LogMelStream stream;
        std::vector<float> got;
        std::array<float, kNumMelBands> frame;
        const auto pop_all = [&] {
          while (stream.pop(frame)) got.insert(got.end(), frame.begin(), frame.end());
        };
        for (std::size_t i = 0; i < n; i += chunk) {
          stream.push(std::span(samples).subspan(i, std::min(chunk, n - i)));
          if (!pop_at_the_end) pop_all();
        }
        stream.finish();
        pop_all();
        ASSERT_EQ(got.size(), whole.values.size()) << n << " samples in pieces of " << chunk;
        ASSERT_EQ(std::memcmp(got.data(), whole.values.data(), got.size() * sizeof(float)), 0)
            << n << " samples in pieces of " << chunk;
        EXPECT_EQ(stream.num_popped(), whole.num_frames());
        EXPECT_FALSE(stream.pop(frame));
      }
    }
  }
}

TEST(LogMelStream, FrameIsReadyWithTheLastSampleItHears) {
  LogMelStream stream;
  std::array<float, kNumMelBands> frame;
  std::int64_t ready = 0;
  for (std::int64_t pushed = 0; pushed < 1000; ++pushed) {
    stream.push(std::vector<float>{0.1f});
    while (stream.pop(frame)) {
      EXPECT_EQ(pushed, 160 * ready + 199);
      ++ready;
    }
  }
  EXPECT_EQ(ready, 6);
}

TEST(LogMelStream, PushAfterFinishIsAMistake) {
  LogMelStream stream;
  stream.finish();
  stream.finish();  // harmless
  EXPECT_THROW(stream.push(std::vector<float>{0.0f}), std::logic_error);
}

}  // namespace
}  // namespace mien
