#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "mien/audio/load_audio.h"
#include "test_wav.h"

namespace mien {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

Result<AudioClip> load(const Bytes& bytes) { return load_audio(TemporaryFile(bytes).path()); }
Result<AudioClip> load(const WavFields& fields, const Bytes& data) { return load(wav_file(fields, data)); }

// `cycle` over and over, 400 times: long enough to be accepted.
template <class T>
Bytes repeat(const std::vector<T>& cycle) {
  Bytes data;
  for (int i = 0; i < 400; ++i) {
    const Bytes once = as_data(cycle);
    data.insert(data.end(), once.begin(), once.end());
  }
  return data;
}

std::vector<float> first_samples(const Result<AudioClip>& clip, std::size_t n) {
  if (!clip) ADD_FAILURE() << clip.error().message();
  return clip ? std::vector<float>(clip->samples.begin(),
                                   clip->samples.begin() + static_cast<std::ptrdiff_t>(n))
              : std::vector<float>{};
}

TEST(Wav, EveryPlainCoding) {
  EXPECT_THAT(first_samples(load({.bits = 8}, repeat<std::uint8_t>({0, 128, 192, 255})), 4),
              ElementsAre(-1.0f, 0.0f, 0.5f, 127.0f / 128));
  EXPECT_THAT(first_samples(load({.bits = 16}, repeat<std::int16_t>({-32768, 16384})), 2),
              ElementsAre(-1.0f, 0.5f));
  EXPECT_THAT(
      first_samples(load({.bits = 24}, repeat<std::uint8_t>({0, 0, 0x80, 0, 0, 0x40, 0xff, 0xff, 0xff})), 3),
      ElementsAre(-1.0f, 0.5f, -1.0f / 8388608));
  EXPECT_THAT(first_samples(load({.bits = 32}, repeat<std::int32_t>({INT32_MIN, 1 << 30})), 2),
              ElementsAre(-1.0f, 0.5f));
  EXPECT_THAT(first_samples(load({.tag = 3, .bits = 32}, repeat<float>({-4.5f, 0.25f})), 2),
              ElementsAre(-4.5f, 0.25f));
  EXPECT_THAT(first_samples(load({.tag = 3, .bits = 64}, repeat<double>({-4.5, 0.25})), 2),
              ElementsAre(-4.5f, 0.25f));
  // ITU-T G.711, tables 1a and 2a: the largest, the smallest and one middle code; A-law in 1/4096, mu-law in
  // 1/8192.
  EXPECT_THAT(
      first_samples(load({.tag = 6, .bits = 8}, repeat<std::uint8_t>({0xaa, 0x2a, 0xd5, 0x55, 0x80})), 5),
      ElementsAre(4032 / 4096.0f, -4032 / 4096.0f, 1 / 4096.0f, -1 / 4096.0f, 688 / 4096.0f));
  EXPECT_THAT(
      first_samples(load({.tag = 7, .bits = 8}, repeat<std::uint8_t>({0x80, 0x00, 0xff, 0xfe, 0x8f})), 5),
      ElementsAre(8031 / 8192.0f, -8031 / 8192.0f, 0.0f, 2 / 8192.0f, 4191 / 8192.0f));
}

TEST(Wav, MonoIsTheMeanOfTheChannels) {
  const auto clip = load({.num_channels = 3}, repeat<std::int16_t>({3000, 6000, 12000}));
  EXPECT_THAT(first_samples(clip, 2), ElementsAre(7000 / 32768.0f, 7000 / 32768.0f));
  EXPECT_EQ(clip->samples.size(), 400u);
}

TEST(Wav, EachWrongFieldHasItsOwnMessage) {
  const Bytes data = as_data(ramp16(1000));
  struct Case {
    WavFields fields;
    const char* message;
  };
  const Case cases[] = {
      {{.num_channels = 0}, "0 channels, expected 1 to 64"},
      {{.num_channels = 65}, "65 channels"},
      {{.sample_rate_hz = 0}, "sample rate of 0 Hz, expected 1000 to 768000"},
      {{.sample_rate_hz = 999}, "sample rate of 999 Hz"},
      {{.sample_rate_hz = 4294967295u}, "sample rate of 4294967295 Hz"},
      {{.bits = 12}, "12 bits"},
      {{.bits = 0}, "0 bits"},
      {{.tag = 3, .bits = 16}, "format tag 0x0003"},
      {{.tag = 0x1234}, "format tag 0x1234"},
      {{.tag = 0x55}, "(MP3)"},
      {{.tag = 0xFFFE}, "extensible format without a known sub-format"},
  };
  for (const Case& c : cases) {
    const auto clip = load(c.fields, data);
    ASSERT_FALSE(clip.has_value()) << c.message;
    EXPECT_EQ(clip.error().code, Errc::input);
    EXPECT_THAT(clip.error().what, HasSubstr("mien_audio_"));
    EXPECT_THAT(clip.error().why, HasSubstr(c.message));
  }
  EXPECT_TRUE(load({}, data).has_value());
}

TEST(Wav, WrongBlockAlignIsAWarning) {
  const auto clip = load({.block_align = 7}, as_data(ramp16(1000)));
  ASSERT_TRUE(clip.has_value());
  EXPECT_EQ(clip->samples.size(), 1000u);
  EXPECT_THAT(clip.warnings, ElementsAre(HasSubstr("declares 7 bytes per frame, but 16-bit PCM needs 2")));
}

TEST(Wav, SizesThatLie) {
  const Bytes data = as_data(ramp16(1000));
  const auto cut = load({.data_size = 2000000}, data);
  ASSERT_TRUE(cut.has_value());
  EXPECT_EQ(cut->samples.size(), 1000u);
  EXPECT_THAT(cut.warnings, ElementsAre(HasSubstr("declares 62.500 s, but it ends after 0.062 s")));

  const auto streamed = load({.data_size = 0xFFFFFFFF}, data);
  ASSERT_TRUE(streamed.has_value());
  EXPECT_EQ(streamed->samples.size(), 1000u);
  EXPECT_THAT(streamed.warnings, IsEmpty());

  const auto interrupted = load({.data_size = 0}, data);
  ASSERT_TRUE(interrupted.has_value());
  EXPECT_EQ(interrupted->samples.size(), 1000u);
  EXPECT_THAT(interrupted.warnings, ElementsAre(HasSubstr("declares no samples, but 0.062 s follow")));

  // Size 0 and then an ordinary chunk: really no samples.
  Bytes list;
  append_text(list, "LIST");
  append_le<std::uint32_t>(list, 2000);
  list.resize(2008);
  const auto none = load({.data_size = 0}, list);
  ASSERT_FALSE(none.has_value());
  EXPECT_THAT(none.error().why, HasSubstr("too short: at least 25 ms needed, found 0.0 ms"));

  Bytes odd = data;
  odd.push_back(std::byte{1});
  const auto half = load({}, odd);
  ASSERT_TRUE(half.has_value());
  EXPECT_EQ(half->samples.size(), 1000u);
  EXPECT_THAT(half.warnings, ElementsAre(HasSubstr("incomplete frame")));
}

TEST(Wav, SoundBeforeItsFormatIsAccepted) {
  const Bytes data = as_data(ramp16(500));
  Bytes wav;
  append_text(wav, "RIFF....WAVEdata");
  append_le<std::uint32_t>(wav, static_cast<std::uint32_t>(data.size()));
  wav.insert(wav.end(), data.begin(), data.end());
  append_format(wav, {});
  const auto clip = load(wav);
  ASSERT_TRUE(clip.has_value()) << clip.error().message();
  EXPECT_EQ(clip->samples.size(), 500u);
}

// Sony's Wave64: 16-byte names, sizes of 64 bits that count the 24 bytes of the chunk header, chunks at
// multiples of 8.
Bytes wave64_file(const Bytes& data, std::uint64_t declared_data) {
  Bytes w64;
  const auto append_chunk = [&](std::string_view name, std::string_view rest_of_name, std::uint64_t size) {
    append_text(w64, name);
    append_text(w64, rest_of_name);
    append_le<std::uint64_t>(w64, size);
  };
  using namespace std::string_view_literals;
  const auto rest = "\xf3\xac\xd3\x11\x8c\xd1\x00\xc0\x4f\x8e\xdb\x8a"sv;
  append_chunk("riff", "\x2e\x91\xcf\x11\xa5\xd6\x28\xdb\x04\xc1\x00\x00"sv, 1000);
  append_text(w64, "wave");
  append_text(w64, rest);
  Bytes format;
  append_format(format, {});
  append_chunk("fmt ", rest, 24 + 16);
  w64.insert(w64.end(), format.begin() + 8, format.end());
  append_chunk("levl", rest, 24 + 3);
  append_text(w64, "abc.....");  // 3 bytes and the way to the next multiple of 8
  append_chunk("data", rest, declared_data);
  w64.insert(w64.end(), data.begin(), data.end());
  return w64;
}

TEST(Wav, Wave64) {
  const Bytes data = as_data(ramp16(500));
  const auto clip = load(wave64_file(data, 24 + 1000));
  ASSERT_TRUE(clip.has_value()) << clip.error().message();
  EXPECT_EQ(clip->samples.size(), 500u);
  EXPECT_FLOAT_EQ(clip->samples[1], -9903.0f / 32768);
  EXPECT_THAT(clip.warnings, IsEmpty());
  const auto cut = load(wave64_file(data, UINT64_MAX));
  ASSERT_TRUE(cut.has_value()) << cut.error().message();
  EXPECT_EQ(cut->samples.size(), 500u);
  EXPECT_THAT(cut.warnings, ElementsAre(HasSubstr("the file is cut")));
  EXPECT_FALSE(load(wave64_file(data, 23)).has_value());  // smaller than its own header
}

TEST(Wav, EveryTruncationIsAnErrorOrAWarning) {
  const Bytes whole = wav_file({}, as_data(ramp16(450)));
  for (std::size_t n = 0; n < whole.size(); ++n) {
    const auto clip = load(Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(n)));
    const std::size_t num_samples = n < 44 ? 0 : (n - 44) / 2;
    ASSERT_EQ(clip.has_value(), num_samples >= 400) << "cut to " << n << " bytes";
    if (!clip) {
      EXPECT_EQ(clip.error().code, Errc::input);
      EXPECT_FALSE(clip.error().why.empty());
      continue;
    }
    EXPECT_EQ(clip->samples.size(), num_samples);
    EXPECT_FALSE(clip.warnings.empty()) << "cut to " << n << " bytes";
  }
  EXPECT_TRUE(load(whole).has_value());
  EXPECT_THAT(load(whole).warnings, IsEmpty());
}

TEST(Wav, FlippedHeaderBytesNeverGiveMoreThanIsThere) {
  const Bytes whole = wav_file({}, as_data(ramp16(450)));
  for (std::size_t i = 0; i < 44; ++i) {
    for (int bit = 0; bit < 8; ++bit) {
      Bytes damaged = whole;
      damaged[i] ^= static_cast<std::byte>(1 << bit);
      const auto clip = load(damaged);
      // Slowest rate that is accepted and smallest coding: 900 bytes, 16 samples out for each in.
      if (!clip) continue;
      ASSERT_LE(clip->samples.size(), 900u * 16 + 1) << "byte " << i << " bit " << bit;
    }
  }
}

}  // namespace
}  // namespace mien
