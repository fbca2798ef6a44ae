#include "small_set.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include "mien/io/safetensors.h"

namespace mien::train {

std::filesystem::path write_small_set(const std::filesystem::path& path) {
  constexpr std::int64_t kEntries = 4, kTakes = 2, kFrames = 360, kMel = 601;
  const std::int64_t n = kEntries * kFrames, t = kEntries * kMel;
  auto writer = SafetensorsWriter::create(path, {{"mel", Dtype::f16, {t, 64}},
                                                 {"curves", Dtype::f16, {kTakes, n, 55}},
                                                 {"level", Dtype::f32, {t}},
                                                 {"latent", Dtype::f32, {kTakes, kEntries, 3}},
                                                 {"blink_onset", Dtype::u8, {kTakes, n}},
                                                 {"brow_raise", Dtype::u8, {kTakes, n}},
                                                 {"viseme", Dtype::u8, {n}},
                                                 {"closure", Dtype::u8, {n}},
                                                 {"accent", Dtype::u8, {n}},
                                                 {"mel_start", Dtype::i64, {kEntries + 1}},
                                                 {"frame_start", Dtype::i64, {kEntries + 1}},
                                                 {"style", Dtype::u8, {kTakes, kEntries}},
                                                 {"emotion", Dtype::u8, {kEntries}},
                                                 {"intensity", Dtype::f32, {kEntries}},
                                                 {"split", Dtype::u8, {kEntries}}});
  std::vector<float> mel, curves, level(t, -3.0f), latent(kTakes * kEntries * 3, 0.1f),
      intensity(kEntries, 1.0f);
  std::vector<std::uint8_t> blink, raise, viseme, flags(n, 0), style(kTakes * kEntries, 2), zero(kEntries, 0);
  std::vector<std::int64_t> mel_start, frame_start;
  const auto loud = [](double seconds) { return 0.5 + 0.5 * std::sin(9 * seconds); };
  for (std::int64_t i = 0; i < t; ++i)
    for (int b = 0; b < 64; ++b)
      mel.push_back(static_cast<float>(-12 + 9 * loud(static_cast<double>(i % kMel) / 100)));
  for (std::int64_t k = 0; k < kTakes; ++k)
    for (std::int64_t i = 0; i < n; ++i) {
      std::vector<float> frame(55, 0.0f);
      frame[17] = static_cast<float>(0.6 * loud(static_cast<double>(i % kFrames) / 60));
      frame[52] = static_cast<float>(3 * std::sin(static_cast<double>(i) / 40));
      curves.insert(curves.end(), frame.begin(), frame.end());
      blink.push_back(i % 120 == 60);
      raise.push_back(i % 90 == 30 ? 64 : 0);
    }
  for (std::int64_t i = 0; i < n; ++i)
    viseme.push_back(loud(static_cast<double>(i % kFrames) / 60) > 0.5 ? 14 : 0);
  // The raises of the first two entries belong to accents three frames after their centres.
  auto accent = flags;
  for (std::int64_t i = 0; i < 2 * kFrames; ++i) accent[static_cast<std::size_t>(i)] = i % 90 == 33;
  for (std::int64_t i = 0; i <= kEntries; ++i)
    mel_start.push_back(i * kMel), frame_start.push_back(i * kFrames);
  EXPECT_TRUE(writer->write_float("mel", mel));
  EXPECT_TRUE(writer->write_float("curves", curves));
  EXPECT_TRUE(writer->write("level", level));
  EXPECT_TRUE(writer->write("latent", latent));
  EXPECT_TRUE(writer->write("blink_onset", blink));
  EXPECT_TRUE(writer->write("brow_raise", raise));
  EXPECT_TRUE(writer->write("viseme", viseme));
  EXPECT_TRUE(writer->write("closure", flags));
  EXPECT_TRUE(writer->write("accent", accent));
  EXPECT_TRUE(writer->write("mel_start", mel_start));
  EXPECT_TRUE(writer->write("frame_start", frame_start));
  EXPECT_TRUE(writer->write("style", style));
  EXPECT_TRUE(writer->write("emotion", zero));
  EXPECT_TRUE(writer->write("intensity", intensity));
  EXPECT_TRUE(writer->write("split", zero));
  EXPECT_TRUE(writer->finish());
  return path;
}

}  // namespace mien::train
