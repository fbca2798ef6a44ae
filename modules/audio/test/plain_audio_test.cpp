// load_audio() as it is without soxr and the FFmpeg libraries.
#include <gmock/gmock.h>

#include <cmath>

#include "mien/audio/load_audio.h"
#include "test_wav.h"

namespace mien {
namespace {

using ::testing::HasSubstr;

Bytes tone(const WavFields& fields, int num_frames) {
  std::vector<std::int16_t> samples;
  for (int n = 0; n < num_frames; ++n)
    for (int c = 0; c < fields.num_channels; ++c)
      samples.push_back(static_cast<std::int16_t>(std::lround(9000 * std::sin(0.1 * n))));
  return wav_file(fields, as_data(samples));
}

TEST(PlainAudio, ReadsWavAt16KilohertzAsItIs) {
  for (const std::uint16_t channels : {std::uint16_t{1}, std::uint16_t{2}}) {
    WavFields fields;
    fields.num_channels = channels;
    const TemporaryFile file(tone(fields, 4000));
    const auto clip = load_audio(file.path());
    ASSERT_TRUE(clip) << clip.error().message();
    ASSERT_EQ(clip->samples.size(), 4000u);
    for (int n = 0; n < 4000; n += 37)
      EXPECT_NEAR(clip->samples[static_cast<std::size_t>(n)], std::sin(0.1 * n) * 9000 / 32768, 1e-4) << n;
  }
}

TEST(PlainAudio, SaysWhatNeedsALibrary) {
  WavFields fields;
  fields.sample_rate_hz = 44100;
  const TemporaryFile other_rate(tone(fields, 9000));
  const auto rate = load_audio(other_rate.path());
  ASSERT_FALSE(rate);
  EXPECT_EQ(rate.error().code, Errc::input);
  EXPECT_THAT(rate.error().message(), HasSubstr("44100 Hz"));
  EXPECT_THAT(rate.error().message(), HasSubstr("16000"));

  Bytes flac;
  append_text(flac, "fLaC");
  flac.resize(5000);
  const auto coded = load_audio(TemporaryFile(flac, ".flac").path());
  ASSERT_FALSE(coded);
  EXPECT_EQ(coded.error().code, Errc::input);
  EXPECT_THAT(coded.error().message(), HasSubstr("without decoders"));
}

TEST(PlainAudio, RefusesWhatIsEmptyShortOrNoSound) {
  EXPECT_FALSE(load_audio(TemporaryFile(Bytes()).path()));
  EXPECT_FALSE(load_audio(TemporaryFile(tone({}, 100)).path()));
  Bytes text;
  append_text(text, "not a sound at all, but a text that goes on for a while\n");
  EXPECT_FALSE(load_audio(TemporaryFile(text, ".txt").path()));
  EXPECT_FALSE(load_audio("nowhere.wav"));
}

}  // namespace
}  // namespace mien
