// Every file of the shared test audio behaves as its manifest says.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "mien/audio/load_audio.h"
#include "mien/base/file.h"
#include "resampler.h"
#include "test_sound.h"
#include "test_wav.h"

namespace mien {
namespace {

using nlohmann::json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr const char* kAbsent = "manifest_is_absent";

const json& manifest() {
  static const json content = [] {
    std::ifstream in(shared_audio() / "manifest.json");
    return in ? json::parse(in) : json::object();
  }();
  return content;
}

std::vector<std::string> sound_files() {
  std::vector<std::string> names;
  for (const auto& [name, entry] : manifest().items())
    if (!name.starts_with("resample/") && !name.starts_with("human/")) names.push_back(name);
  return names.empty() ? std::vector<std::string>{kAbsent} : names;
}

double rms(const std::vector<float>& samples) {
  double sum = 0;
  for (const float x : samples) sum += static_cast<double>(x) * x;
  return std::sqrt(sum / static_cast<double>(samples.size()));
}

class SharedAudio : public ::testing::TestWithParam<std::string> {};

// Broken files: `expect` is one of a few sentences.
void check_broken(const std::string& expect, const std::string& name, const Result<AudioClip>& clip) {
  if (expect.starts_with("clear error,")) {
    EXPECT_FALSE(clip.has_value());
  } else if (expect != "accept or clear error" && clip.has_value()) {
    EXPECT_FALSE(clip.warnings.empty()) << "accepted without a warning";
  }
  if (clip) return;
  EXPECT_EQ(clip.error().code, Errc::input);
  EXPECT_THAT(clip.error().what, HasSubstr(name));
  EXPECT_GT(clip.error().why.size(), 15u) << clip.error().why;
}

TEST_P(SharedAudio, BehavesAsItsManifestSays) {
  const std::string& name = GetParam();
  if (name == kAbsent)
    GTEST_SKIP() << shared_audio() / "manifest.json"
                 << " is absent";
  const json& entry = manifest().at(name);
  const auto path = shared_audio() / name;
  ::testing::internal::CaptureStderr();
  const auto clip = load_audio(path);
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "") << "a library printed";
  SCOPED_TRACE(clip ? std::string("accepted") : clip.error().message());
  if (entry.contains("expect")) return check_broken(entry["expect"], name, clip);

  const json& decoded = entry.at("decoded");
  const auto num_in = decoded["frames"].get<std::int64_t>();
  const int rate = decoded["rate"];
  const int channels = decoded["channels"];
  const std::int64_t num_out = (num_in * 16000 + rate - 1) / rate;
  if (num_out < kMinAudioSamples) {
    ASSERT_FALSE(clip.has_value());
    EXPECT_THAT(clip.error().why, HasSubstr("too short: at least 25 ms needed"));
    return;
  }
  if (name.find("_nan") != name.npos || name.find("_inf") != name.npos) {
    ASSERT_FALSE(clip.has_value());
    EXPECT_THAT(clip.error().why, HasSubstr("sample 3000 (0.188 s)"));
    return;
  }
  ASSERT_TRUE(clip.has_value());
  const char* const odd[] = {"antiphase", "size_zero", "silence_1s", "clipped", "square_full_scale"};
  const bool is_odd =
      std::any_of(std::begin(odd), std::end(odd), [&](const char* o) { return name.find(o) != name.npos; });
  EXPECT_EQ(clip.warnings.size(), is_odd ? 1u : 0u) << ::testing::PrintToString(clip.warnings);
  EXPECT_EQ(clip->sample_rate_hz, 16000);
  const auto reader = AudioReader::open(path);
  ASSERT_TRUE(reader.has_value());
  EXPECT_EQ(reader->info().sample_rate_hz, rate);
  EXPECT_EQ(reader->info().num_channels, channels);
  EXPECT_EQ(static_cast<std::int64_t>(clip->samples.size()), num_out);
  for (const float x : clip->samples) ASSERT_TRUE(std::isfinite(x));
  if (channels > 1) return;  // the manifest describes single channels
  const double want = decoded["rms"][0];
  EXPECT_NEAR(rms(clip->samples), want, rate == 16000 ? 1e-5 * (1 + want) : 0.01 * want);
  if (rate != 16000) return;
  std::vector<float> nonzero;
  for (std::size_t i = 0; i < clip->samples.size() && nonzero.size() < 3; ++i)
    if (clip->samples[i] != 0.0f) nonzero.push_back(clip->samples[i]);
  EXPECT_THAT(nonzero, ::testing::Pointwise(::testing::FloatNear(1e-7f),
                                            decoded["first_nonzero"].get<std::vector<float>>()));
}

std::string test_name(const ::testing::TestParamInfo<std::string>& info) {
  std::string name;
  for (const char c : info.param) name += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
  return name;
}
INSTANTIATE_TEST_SUITE_P(Files, SharedAudio, ::testing::ValuesIn(sound_files()), test_name);

std::vector<float> load_shared(const std::string& name) {
  const auto clip = load_audio(shared_audio() / name);
  if (!clip) ADD_FAILURE() << clip.error().message();
  return clip ? clip->samples : std::vector<float>{};
}

// All files of formats/ hold the same half second; whatever the coding, it must lie at the same place in
// time.
TEST(SharedFormats, NoCodingMovesTheSound) {
  if (manifest().empty())
    GTEST_SKIP() << shared_audio() / "manifest.json"
                 << " is absent";
  const auto reference = load_shared("formats/flac_mono_16000.flac");
  for (const auto& [name, entry] : manifest().items()) {
    if (!name.starts_with("formats/") || name.find("antiphase") != name.npos) continue;
    const auto samples = load_shared(name);
    ASSERT_GE(samples.size(), 4800u) << name;
    double best = 0;
    int best_lag = 999;
    for (int lag = -100; lag <= 100; ++lag) {
      double sum = 0;
      for (std::int64_t i = 100; i < 4700; ++i) sum += static_cast<double>(reference[i]) * samples[i + lag];
      if (sum > best) best = sum, best_lag = lag;
    }
    EXPECT_EQ(best_lag, 0) << name;
  }
}

TEST(SharedFormats, OddFilesWarn) {
  if (manifest().empty())
    GTEST_SKIP() << shared_audio() / "manifest.json"
                 << " is absent";
  const auto warnings = [](const char* name) { return load_audio(shared_audio() / name).warnings; };
  EXPECT_THAT(warnings("formats/antiphase_s16_16000.wav"), ElementsAre(HasSubstr("cancel each other")));
  EXPECT_THAT(warnings("formats/streamed_size_zero_16000.wav"),
              ElementsAre(HasSubstr("declares no samples")));
  EXPECT_THAT(warnings("levels/silence_1s.wav"), ElementsAre(HasSubstr("silent")));
  EXPECT_THAT(warnings("levels/clipped.wav"), ElementsAre(HasSubstr("clipped")));
  // The damaged frame becomes silence, and what follows stays on time.
  EXPECT_THAT(warnings("broken/flac_bitflip.flac"),
              ElementsAre(HasSubstr("0.072 s were replaced by silence")));
  const auto damaged = load_shared("broken/flac_bitflip.flac");
  const auto whole = load_shared("formats/flac_mono_16000.flac");
  ASSERT_EQ(damaged.size(), whole.size());
  for (std::size_t i = 0; i < whole.size(); ++i)
    ASSERT_EQ(damaged[i], i < 1152 ? 0.0f : whole[i]) << "sample " << i;
}

TEST(SharedFormats, CutFilesAreRefusedOrWarn) {
  if (manifest().empty())
    GTEST_SKIP() << shared_audio() / "manifest.json"
                 << " is absent";
  for (const auto& [name, entry] : manifest().items()) {
    if (!name.starts_with("formats/")) continue;
    const auto bytes = read_file(shared_audio() / name);
    ASSERT_TRUE(bytes.has_value());
    for (const double share : {0.02, 0.1, 0.3, 0.5, 0.7}) {
      const auto size = static_cast<std::ptrdiff_t>(share * static_cast<double>(bytes->size()));
      const auto clip =
          load_audio(TemporaryFile(Bytes(bytes->begin(), bytes->begin() + size), ".bin").path());
      const bool is_endless =
          name.find("streamed_size") != name.npos;  // no header tells how long it should be
      EXPECT_TRUE(!clip || is_endless || !clip.warnings.empty()) << name << " cut to " << share;
    }
  }
}

// RFC 3533, page checksum: polynomial 0x04c11db7, computed with zeros in its own place (bytes 22 to 25).
void sign_ogg_page(std::span<std::byte> page) {
  std::fill_n(page.begin() + 22, 4, std::byte{0});
  std::uint32_t crc = 0;
  for (const std::byte b : page) {
    crc ^= static_cast<std::uint32_t>(b) << 24;
    for (int i = 0; i < 8; ++i) crc = (crc << 1) ^ ((crc >> 31) * 0x04c11db7u);
  }
  for (int i = 0; i < 4; ++i) page[22 + i] = static_cast<std::byte>(crc >> (8 * i));
}

TEST(SharedFormats, OggThatEndsBetweenPagesWarns) {
  auto bytes = read_file(shared_audio() / "formats" / "vorbis_mono_16000.ogg");
  if (!bytes) GTEST_SKIP() << bytes.error().message();
  const auto last = std::span(*bytes).subspan(as_text(*bytes).rfind("OggS"));
  last[5] &= ~std::byte{4};  // one more page should follow
  sign_ogg_page(last);
  const auto clip = load_audio(TemporaryFile(*bytes, ".ogg").path());
  ASSERT_TRUE(clip.has_value()) << clip.error().message();
  EXPECT_THAT(clip.warnings, ElementsAre(HasSubstr("its last page is missing")));
}

TEST(SharedFormats, ChangingSampleRateIsAnError) {
  auto bytes = read_file(shared_audio() / "formats" / "mp3_mono_16000.mp3");
  const auto more = read_file(shared_audio() / "formats" / "mp3_stereo_44100.mp3");
  if (!bytes || !more)
    GTEST_SKIP() << shared_audio() / "formats"
                 << " is absent";
  bytes->insert(bytes->end(), more->begin(), more->end());
  const auto clip = load_audio(TemporaryFile(*bytes, ".mp3").path());
  ASSERT_FALSE(clip.has_value());
  EXPECT_THAT(clip.error().why, HasSubstr("sample rate changes from 16000 to 44100 Hz"));
}

TEST(SharedFormats, FlippedBytesNeverCrash) {
  if (manifest().empty())
    GTEST_SKIP() << shared_audio() / "manifest.json"
                 << " is absent";
  Rng rng(11);
  for (const auto& [name, entry] : manifest().items()) {
    if (!name.starts_with("formats/")) continue;
    const auto bytes = read_file(shared_audio() / name);
    ASSERT_TRUE(bytes.has_value());
    for (int round = 0; round < 8; ++round) {
      Bytes damaged = *bytes;
      for (int i = 0; i < 1 + round; ++i)
        damaged[rng.below(round % 2 == 0 ? 64 : damaged.size())] ^=
            static_cast<std::byte>(1 + rng.below(255));
      const auto clip = load_audio(TemporaryFile(damaged, ".bin").path());
      if (!clip) continue;
      for (const float x : clip->samples) ASSERT_TRUE(std::isfinite(x)) << name;
    }
  }
}

TEST(SharedResample, EqualsTheReference) {
  const auto bytes = read_file(shared_audio() / "resample" / "resample_refs.safetensors");
  if (!bytes) GTEST_SKIP() << bytes.error().message();
  const auto header_size = read_le<std::uint64_t>(*bytes, 0).value();
  const json header = json::parse(as_text(*bytes).substr(8, header_size));
  const auto tensor = [&](const std::string& name) {
    const std::size_t start = header.at(name)["data_offsets"][0], end = header.at(name)["data_offsets"][1];
    std::vector<float> values((end - start) / 4);
    std::memcpy(values.data(), bytes->data() + 8 + header_size + start, end - start);
    return values;
  };
  for (const int rate : {8000, 22050, 44100, 48000}) {
    const auto in = tensor("in_" + std::to_string(rate));
    const auto want = tensor("soxr_hq_" + std::to_string(rate) + "_to_16000");
    const auto other = tensor("torchaudio_" + std::to_string(rate) + "_to_16000");
    Resampler resampler(rate);
    std::vector<float> got;
    resampler.push(in, got);
    resampler.finish(got);
    ASSERT_EQ(got.size(),
              (in.size() * 16000 + static_cast<std::size_t>(rate) - 1) / static_cast<std::size_t>(rate));
    ASSERT_EQ(got.size(), other.size());
    const auto distance = [&](const std::vector<float>& reference) {
      double sum = 0;
      const std::size_t n = std::min(got.size(), reference.size());
      for (std::size_t i = 0; i < n; ++i) sum += std::pow(static_cast<double>(got[i]) - reference[i], 2);
      return std::sqrt(sum / static_cast<double>(n));
    };
    EXPECT_LT(distance(want), 1e-6) << rate << " Hz";   // measured: 0
    EXPECT_LT(distance(other), 2e-3) << rate << " Hz";  // another filter; measured: up to 2.1e-4
  }
}

}  // namespace
}  // namespace mien
