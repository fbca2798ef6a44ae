#include "mien/audio/running_level.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "mien/base/bytes.h"
#include "mien/base/file.h"
#include "test_sound.h"

namespace mien {
namespace {

using Frame = std::array<float, kNumMelBands>;

Frame flat(float level) {
  Frame frame;
  frame.fill(level);
  return frame;
}

float percentile_95(std::vector<float> values) {
  std::sort(values.begin(), values.end());
  const double position = 0.95 * static_cast<double>(values.size() - 1);
  const auto i = static_cast<std::size_t>(position);
  const float next = values[std::min(i + 1, values.size() - 1)];
  return static_cast<float>(values[i] + (position - static_cast<double>(i)) * (next - values[i]));
}

TEST(RunningLevel, IsThePercentileOfTheLastFourSeconds) {
  Rng rng(5);
  RunningLevel running;
  std::vector<float> history;
  for (int t = 0; t < 1500; ++t) {
    // Rounded, so that equal values enter and leave the window too.
    const float level = kSpeechLevel + static_cast<float>(std::round(rng.normal(0.0, 6.0)));
    history.push_back(frame_level(flat(level)));
    const std::size_t start = history.size() > 400 ? history.size() - 400 : 0;
    const std::vector<float> window(history.begin() + static_cast<std::ptrdiff_t>(start), history.end());
    ASSERT_NEAR(running.push(flat(level)), std::max(percentile_95(window), kLevelFloor), 1e-5)
        << "frame " << t;
  }
}

TEST(RunningLevel, ForgetsASoundAfterFourSeconds) {
  RunningLevel running;
  for (int t = 0; t < 100; ++t) running.push(flat(kSpeechLevel + 5.0f));
  EXPECT_FLOAT_EQ(running.push(flat(-16.0f)), kSpeechLevel + 5.0f);
  float level = 0.0f;
  for (int t = 0; t < 400; ++t) level = running.push(flat(-16.0f));
  EXPECT_EQ(level, kLevelFloor);
}

TEST(RunningLevel, SilenceStaysAtTheFloor) {
  EXPECT_NEAR(kLevelFloor, kSpeechLevel - 9.0 * std::log(10.0) / 10.0, 1e-6);
  for (const float level : running_levels(log_mel(std::vector<float>(8000, 0.0f))))
    ASSERT_EQ(level, kLevelFloor);
  EXPECT_TRUE(running_levels(Features{.values = {}, .width = kNumMelBands, .frame_rate_hz = 100}).empty());
}

TEST(RunningLevel, RefusesWhatWouldPoisonIt) {
  RunningLevel running;
  EXPECT_THROW(running.push(flat(std::numeric_limits<float>::quiet_NaN())), std::logic_error);
  EXPECT_THROW(running.push(flat(std::numeric_limits<float>::infinity())), std::logic_error);
  EXPECT_THROW(running_levels(Features{.values = {1.0f}, .width = 1, .frame_rate_hz = 100}),
               std::logic_error);
}

TEST(NormaliseMel, IsTheFormulaOfTheSpecification) {
  EXPECT_FLOAT_EQ(normalise_mel(-3.0f, -3.0f), 5.0f / 3.5f);
  EXPECT_FLOAT_EQ(normalise_mel(-8.0f, -3.0f), 0.0f);
  EXPECT_FLOAT_EQ(normalise_mel(-40.0f, -3.0f), -9.0f / 3.5f);  // clamped at 14 below the level
  Frame frame = flat(-8.0f);
  frame[7] = -40.0f;
  normalise_mel(frame, -3.0f, frame);
  EXPECT_FLOAT_EQ(frame[0], 0.0f);
  EXPECT_FLOAT_EQ(frame[7], -9.0f / 3.5f);
}

// The measurement behind kSpeechLevel.
TEST(SpeechLevel, IsWhatCleanSpeechAtRms006Has) {
  const auto folder = shared_audio() / "speech";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is absent";
  double sum = 0;
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const auto bytes = read_file(entry.path());
    ASSERT_TRUE(bytes.has_value());
    std::vector<float> samples;  // plain 16-bit wav with a 44-byte header, see the folder's README
    for (std::size_t i = 44; i + 1 < bytes->size(); i += 2)
      samples.push_back(static_cast<float>(*read_le<std::int16_t>(*bytes, i)) / 32768.0f);
    double energy = 0;
    for (const float x : samples) energy += double(x) * x;
    const float gain = 0.06f / static_cast<float>(std::sqrt(energy / static_cast<double>(samples.size())));
    for (float& x : samples) x *= gain;
    const Features mel = log_mel(samples);
    std::vector<float> levels;
    for (std::int64_t t = 0; t < mel.num_frames(); ++t)
      levels.push_back(frame_level(mel.frame(t).first<kNumMelBands>()));
    const float level = percentile_95(levels);
    EXPECT_NEAR(level, kSpeechLevel, 2.0) << entry.path();
    sum += level;
    ++count;
  }
  ASSERT_EQ(count, 18);
  EXPECT_NEAR(sum / count, kSpeechLevel, 0.01);
}

}  // namespace
}  // namespace mien
