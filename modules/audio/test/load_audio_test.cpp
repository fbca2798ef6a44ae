#include "mien/audio/load_audio.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <numbers>

#include "input_file.h"
#include "mien/base/random.h"
#include "ogg_end.h"
#include "resampler.h"
#include "test_sound.h"
#include "test_wav.h"

namespace mien {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

Bytes float_wav(const std::vector<float>& samples, std::uint16_t num_channels = 1,
                std::uint32_t rate = 16000) {
  return wav_file({.tag = 3, .num_channels = num_channels, .sample_rate_hz = rate, .bits = 32},
                  as_data(samples));
}

// Sun AU, big-endian 16-bit PCM: read by the general decoder.
Bytes au_file(const std::vector<std::int16_t>& samples) {
  Bytes au;
  append_text(au, ".snd");
  const auto append_be = [&](std::uint32_t v) {
    for (int shift = 24; shift >= 0; shift -= 8) au.push_back(static_cast<std::byte>(v >> shift));
  };
  for (const std::size_t v :
       {std::size_t{24}, 2 * samples.size(), std::size_t{3}, std::size_t{16000}, std::size_t{1}})
    append_be(static_cast<std::uint32_t>(v));
  for (const std::int16_t s : samples) {
    au.push_back(static_cast<std::byte>(static_cast<std::uint16_t>(s) >> 8));
    au.push_back(static_cast<std::byte>(s & 255));
  }
  return au;
}

std::string error_of(const Bytes& bytes, std::string_view ending = ".wav") {
  const auto clip = load_audio(TemporaryFile(bytes, ending).path());
  EXPECT_FALSE(clip.has_value());
  if (clip) return "";
  EXPECT_EQ(clip.error().code, Errc::input);
  return clip.error().message();
}

TEST(LoadAudio, WhatIsNotAFile) {
  const auto folder = load_audio(std::filesystem::temp_directory_path());
  ASSERT_FALSE(folder.has_value());
  EXPECT_THAT(folder.error().message(), HasSubstr("is a folder"));
  const auto missing = load_audio("no/such/file.wav");
  ASSERT_FALSE(missing.has_value());
  EXPECT_THAT(missing.error().message(), HasSubstr("'no/such/file.wav': file not found"));
  const auto device = load_audio("/dev/null");
  ASSERT_FALSE(device.has_value());
  EXPECT_THAT(device.error().message(), HasSubstr("not a regular file"));
  EXPECT_THAT(error_of({}), HasSubstr("empty (0 bytes)"));
}

TEST(LoadAudio, SaysWhatTheFileIsInstead) {
  const auto text = [](std::string_view s) { return Bytes(as_bytes(s).begin(), as_bytes(s).end()); };
  EXPECT_THAT(error_of(text("version https://git-lfs.github.com/spec/v1\noid sha256:0\n")),
              HasSubstr("git lfs pull"));
  EXPECT_THAT(error_of(text("Dear diary, today nobody said anything.\n")), HasSubstr("a text file"));
  EXPECT_THAT(error_of(text("#EXTM3U\n#EXTINF:1,\nhttp://example.org/a.wav\n"), ".mp3"),
              HasSubstr("a text file"));
  EXPECT_THAT(error_of(text("<html><body>404 not found</body></html>")), HasSubstr("a web page"));
  EXPECT_THAT(error_of(text("\x89PNG\r\n\x1a\n....")), HasSubstr("a PNG picture"));
  EXPECT_THAT(error_of(Bytes(5000)), HasSubstr("zero bytes only"));
  Rng rng(1);
  for (int i = 0; i < 20; ++i) {
    Bytes noise(4096);
    for (auto& b : noise) b = static_cast<std::byte>(rng.below(256));
    EXPECT_THAT(error_of(noise), HasSubstr("no sound recognised in it: it holds unknown binary data"));
  }
}

TEST(LoadAudio, NotANumberNamesItsPlace) {
  std::vector<float> samples(20000, 0.1f);  // stereo: 10000 frames
  samples[2 * 9000 + 1] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT(error_of(float_wav(samples, 2)), HasSubstr("sample 9000 (0.562 s) of channel 2 is NaN"));
  samples[2 * 9000 + 1] = 0.0f;
  samples[2] = -std::numeric_limits<float>::infinity();
  EXPECT_THAT(error_of(float_wav(samples, 2)), HasSubstr("sample 1 (0.000 s) of channel 1 is infinite"));
  samples[2] = 3e38f;
  EXPECT_THAT(error_of(float_wav(samples)), HasSubstr("sample 2 (0.000 s) is 3e+38"));
}

TEST(LoadAudio, ErrorOnTheWayIsFinal) {
  std::vector<float> samples(50000, 0.1f);
  samples[40000] = std::numeric_limits<float>::quiet_NaN();
  const TemporaryFile file(float_wav(samples));
  auto reader = AudioReader::open(file.path());
  ASSERT_TRUE(reader.has_value());
  std::vector<float> out(1000);
  int good = 0;
  while (reader->read(out).has_value()) ++good;
  EXPECT_EQ(good, 36);  // nine blocks of 4096
  EXPECT_FALSE(reader->read(out).has_value());
}

TEST(LoadAudio, TooShortSaysHowShort) {
  EXPECT_THAT(error_of(float_wav({})), HasSubstr("found 0.0 ms (0 samples at 16 kHz)"));
  EXPECT_THAT(error_of(float_wav({0.5f})), HasSubstr("1 samples at 16 kHz"));
  EXPECT_THAT(error_of(float_wav(std::vector<float>(399, 0.1f))),
              HasSubstr("too short: at least 25 ms needed"));
  EXPECT_THAT(error_of(float_wav(std::vector<float>(1197, 0.1f), 1, 48000)), HasSubstr("found 24.9 ms"));
  EXPECT_TRUE(load_audio(TemporaryFile(float_wav(std::vector<float>(400, 0.1f))).path()).has_value());
}

TEST(LoadAudio, WarnsOfSoundThatIsNoUse) {
  const auto warnings = [](const std::vector<float>& samples, std::uint16_t channels) {
    return load_audio(TemporaryFile(float_wav(samples, channels)).path()).warnings;
  };
  std::vector<float> opposite, same;
  for (const float x : babble(5000)) {
    opposite.push_back(x);
    opposite.push_back(-x);
    same.push_back(x);
    same.push_back(x);
  }
  EXPECT_THAT(warnings(opposite, 2), ElementsAre(HasSubstr("the channels cancel each other")));
  EXPECT_THAT(warnings(same, 2), IsEmpty());
  EXPECT_THAT(warnings(std::vector<float>(5000, 0.0f), 2), ElementsAre(HasSubstr("silent")));
  std::vector<float> square(5000, 1.0f);
  EXPECT_THAT(warnings(square, 1), ElementsAre(HasSubstr("clipped: 100.0 %")));
  for (float& x : square) x = 4.0f;  // float beyond full scale is not clipped
  EXPECT_THAT(warnings(square, 1), IsEmpty());
}

TEST(LoadAudio, GeneralDecoderSurvivesEveryTruncationAndFlippedBytes) {
  const Bytes whole = au_file(ramp16(450));
  const auto clip = load_audio(TemporaryFile(whole, ".au").path());
  ASSERT_TRUE(clip.has_value()) << clip.error().message();
  ASSERT_EQ(clip->samples.size(), 450u);
  EXPECT_FLOAT_EQ(clip->samples[1], -9903.0f / 32768);
  for (std::size_t n = 0; n < whole.size(); n += n < 40 ? 1 : 17) {
    const auto cut = load_audio(
        TemporaryFile(Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(n))).path());
    if (cut) {
      ASSERT_LE(2 * cut->samples.size(), n) << "cut to " << n << " bytes";
    }
  }
  for (std::size_t i = 0; i < 24; ++i) {
    for (int bit = 0; bit < 8; ++bit) {
      Bytes damaged = whole;
      damaged[i] ^= static_cast<std::byte>(1 << bit);
      (void)load_audio(TemporaryFile(damaged).path());  // an Error or a clip, nothing else
    }
  }
}

// An Ogg page: header of 27 bytes, the length of its segments, their bytes.
Bytes ogg_page(int flags, const std::vector<int>& segments) {
  Bytes page(27);
  std::memcpy(page.data(), "OggS", 4);
  page[5] = static_cast<std::byte>(flags);
  page[26] = static_cast<std::byte>(segments.size());
  for (const int size : segments) page.push_back(static_cast<std::byte>(size));
  for (const int size : segments) page.resize(page.size() + static_cast<std::size_t>(size));
  return page;
}

TEST(OggEnd, LastPageIsMarkedAndWhole) {
  const auto is_complete = [](const Bytes& bytes) {
    const TemporaryFile file(bytes, ".ogg");
    auto input = InputFile::open(file.path());
    return input.has_value() && ogg_is_complete(*input);
  };
  Bytes file = ogg_page(2, {30});
  EXPECT_FALSE(is_complete(file));  // only a first page
  const Bytes last = ogg_page(4, {255, 255, 17});
  file.insert(file.end(), last.begin(), last.end());
  EXPECT_TRUE(is_complete(file));
  file.push_back(std::byte{0});  // something behind it does no harm
  EXPECT_TRUE(is_complete(file));
  file.resize(file.size() - 2);
  EXPECT_FALSE(is_complete(file));
  file.resize(ogg_page(2, {30}).size() + 28);  // cut inside the header
  EXPECT_FALSE(is_complete(file));
  EXPECT_FALSE(is_complete(Bytes(100)));
}

TEST(AudioReader, AnySizeOfRequestGivesTheSameSamples) {
  const TemporaryFile file(float_wav(babble(30011), 1, 44100));
  const auto whole = load_audio(file.path());
  ASSERT_TRUE(whole.has_value());
  ASSERT_EQ(whole->samples.size(), std::size_t{(30011 * 16000 + 44099) / 44100});
  for (const std::size_t size : {1u, 7u, 320u, 100000u}) {
    auto reader = AudioReader::open(file.path());
    ASSERT_TRUE(reader.has_value());
    EXPECT_EQ(reader->info().sample_rate_hz, 44100);
    EXPECT_EQ(reader->info().format, "WAV, 32-bit float");
    std::vector<float> got, block(size);
    for (;;) {
      const auto n = reader->read(block);
      ASSERT_TRUE(n.has_value());
      got.insert(got.end(), block.begin(), block.begin() + static_cast<std::ptrdiff_t>(*n));
      if (*n < size) break;
    }
    EXPECT_EQ(got, whole->samples) << "in pieces of " << size;
    EXPECT_EQ(*reader->read(block), 0u);
  }
}

TEST(AudioReader, ReadsAgainFromTheStart) {
  const TemporaryFile file(float_wav(std::vector<float>(44100, 0.0f), 1, 44100));
  auto reader = AudioReader::open(file.path());
  ASSERT_TRUE(reader.has_value());
  ASSERT_TRUE(reader->rewind()) << "nothing was read";
  std::vector<float> part(1000), whole(20000);
  ASSERT_EQ(*reader->read(part), 1000u);
  ASSERT_TRUE(reader->rewind());
  ASSERT_EQ(*reader->read(whole), 16000u);
  EXPECT_THAT(reader->warnings(), ElementsAre(HasSubstr("silent")));
  ASSERT_TRUE(reader->rewind());
  EXPECT_THAT(reader->warnings(), ElementsAre(HasSubstr("silent")));
  ASSERT_EQ(*reader->read(whole), 16000u);
  EXPECT_THAT(reader->warnings(), ElementsAre(HasSubstr("silent"))) << "said once";
  std::filesystem::remove(file.path());
  EXPECT_FALSE(reader->rewind());
}

// A tone keeps its phase from the first sample to the last: nothing is moved in time.
TEST(Resampler, DoesNotMoveTheSound) {
  for (const int rate : {8000, 11025, 16000, 22050, 44100, 48000, 96000, 192000}) {
    constexpr double kToneHz = 440.0;
    const int num_in = 2 * rate + 1;
    Resampler resampler(rate);
    std::vector<float> out, block;
    for (int i = 0; i < num_in; ++i) {
      block.push_back(static_cast<float>(std::sin(2 * std::numbers::pi * kToneHz * i / rate)));
      if (block.size() == 1000 || i + 1 == num_in) {
        resampler.push(block, out);
        block.clear();
      }
    }
    resampler.finish(out);
    ASSERT_EQ(out.size(), (static_cast<std::size_t>(num_in) * 16000 + rate - 1) / rate);
    double worst = 0;
    for (std::size_t n = 200; n + 200 < out.size(); ++n)
      worst = std::max(worst, std::abs(out[n] - std::sin(2 * std::numbers::pi * kToneHz *
                                                         static_cast<double>(n) / 16000)));
    EXPECT_LT(worst, 1e-4) << rate << " Hz";
  }
}

TEST(Resampler, ShortestInputs) {
  for (const int rate : {1000, 8000, 16000, 44100, 768000}) {
    for (const std::size_t n : {0u, 1u, 2u, 3u}) {
      Resampler resampler(rate);
      std::vector<float> out;
      resampler.push(std::vector<float>(n, 0.5f), out);
      resampler.finish(out);
      EXPECT_EQ(out.size(), (n * 16000 + rate - 1) / rate) << n << " samples at " << rate << " Hz";
    }
  }
}

long resident_kb() {
  long total = 0, resident = 0;
  std::FILE* file = std::fopen("/proc/self/statm", "r");
  if (file == nullptr) return 0;
  const int n = std::fscanf(file, "%ld %ld", &total, &resident);
  std::fclose(file);
  return n == 2 ? resident * 4 : 0;
}

// A sparse file: hours of digital silence that take no place on the disk.
void stream_long_file(std::uint32_t rate, std::int64_t seconds) {
  const std::int64_t data_size = seconds * rate * 2;
  const TemporaryFile file(wav_file({.sample_rate_hz = rate, .data_size = data_size}, {}));
  std::filesystem::resize_file(file.path(), static_cast<std::uintmax_t>(44 + data_size));
  auto reader = AudioReader::open(file.path());
  ASSERT_TRUE(reader.has_value());
  EXPECT_EQ(*reader->info().seconds, static_cast<double>(seconds));
  std::vector<float> block(8192);
  std::int64_t num_samples = 0;
  long early_kb = 0;
  for (;;) {
    const auto n = reader->read(block);
    ASSERT_TRUE(n.has_value());
    num_samples += static_cast<std::int64_t>(*n);
    if (early_kb == 0 && num_samples > seconds * 16000 / 20) early_kb = resident_kb();
    if (*n < block.size()) break;
  }
  EXPECT_EQ(num_samples, seconds * 16000);
  EXPECT_LT(resident_kb() - early_kb, 2000) << "memory grew with the length of the file";
  EXPECT_THAT(reader->warnings(), ElementsAre(HasSubstr("silent")));
}

TEST(AudioReader, ThreeHoursTakeNoMoreMemoryThanNineMinutes) { stream_long_file(16000, 3 * 3600); }
TEST(AudioReader, ResamplingTakesNoMoreMemoryEither) { stream_long_file(48000, 1800); }

}  // namespace
}  // namespace mien
