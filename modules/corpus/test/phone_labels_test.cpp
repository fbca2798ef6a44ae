#include <gtest/gtest.h>

#include <set>
#include <string>

#include "mien/corpus/closure.h"
#include "mien/corpus/prosody.h"
#include "mien/corpus/speaker.h"
#include "mien/corpus/viseme.h"

namespace mien {
namespace {

using enum Viseme;

TEST(Visemes, NamesRoundTrip) {
  std::set<std::string_view> names(viseme_names().begin(), viseme_names().end());
  EXPECT_EQ(names.size(), 28u);
  for (int v = 0; v < kNumVisemes; ++v) {
    const auto viseme = static_cast<Viseme>(v);
    EXPECT_EQ(parse_viseme(name_of(viseme)), viseme);
    EXPECT_GT(viseme_target(viseme).onset_s, 0.04);
  }
  EXPECT_EQ(static_cast<int>(OE), 27);
  EXPECT_EQ(parse_visemes("AA+IH"), (Visemes{AA, IH}));
  EXPECT_EQ(parse_visemes("PP"), (Visemes{PP}));
  for (const char* bad : {"", "+", "AA+", "+AA", "AA+IH+UH", "aa", "AA +IH"})
    EXPECT_FALSE(parse_visemes(bad)) << bad;
}

TEST(Visemes, OfIpa) {
  const std::pair<const char*, Visemes> cases[] = {
      {"", {sil}},   {"_", {sil}}, {"_:", {sil}},    {"p", {PP}},      {"pʰ", {PP}},      {"mʲ", {PP}},
      {"ˈɑː", {AA}}, {"iː", {IY}}, {"aɪ", {AA, IH}}, {"eɪ", {EH, IH}}, {"oʊ", {OW, UH}},  {"aʊ", {AA, UH}},
      {"tʃ", {CH}},  {"t͡ʃ", {CH}}, {"dʒ", {CH}},     {"ts", {SS}},     {"dz", {SS}},      {"θ", {TH}},
      {"ɹ", {RR}},   {"r", {DD}},  {"ɾ", {DD}},      {"əl", {AX, LL}}, {"ɑːɹ", {AA, RR}}, {"aɪə", {AA, IH}},
      {"ɡ", {KK}},   {"g", {KK}},  {"ç", {KK}},      {"y", {UY}},      {"ø", {OE}},       {"œ̃", {OE}},
      {"ɑ̃", {AA}},   {"n̩", {NN}},  {"ᵻ", {AX}},      {"ɪ2", {IH}},     {"ɚ", {ER}},       {"juː", {YY, UW}},
      {"ɛɛ", {EH}},  {"ǃ", {AX}},  {"ʔ", {KK}},      {"ʍ", {WW}},      {"tʲ", {DD}}};
  for (const auto& [phone, expected] : cases) EXPECT_EQ(visemes_of_ipa(phone), expected) << phone;
}

TEST(Visemes, OfBrokenTextNeverCrash) {
  EXPECT_EQ(visemes_of_ipa("\xff"), (Visemes{AX}));
  EXPECT_EQ(visemes_of_ipa("\xc9"), (Visemes{AX})) << "cut off";
  EXPECT_EQ(visemes_of_ipa(std::string_view("a\0", 2)), (Visemes{AA}));
  for (int a = 0; a < 256; ++a)
    for (int b = 0; b < 256; ++b)
      (void)visemes_of_ipa(std::string{static_cast<char>(a), static_cast<char>(b)});
}

TEST(Visemes, OfArpabetAndRussianLabels) {
  EXPECT_EQ(visemes_of_arpabet("AH0"), (Visemes{AH}));
  EXPECT_EQ(visemes_of_arpabet("ay"), (Visemes{AA, IH}));
  EXPECT_EQ(visemes_of_arpabet("ey1"), (Visemes{EH, IY}));
  EXPECT_EQ(visemes_of_arpabet("pau"), (Visemes{sil}));
  EXPECT_EQ(visemes_of_arpabet("zh"), (Visemes{CH}));
  EXPECT_EQ(visemes_of_arpabet("ow"), (Visemes{OW, UH}));
  EXPECT_FALSE(visemes_of_arpabet("qq"));
  EXPECT_EQ(visemes_of_festvox_ru("sch"), (Visemes{CH}));
  EXPECT_EQ(visemes_of_festvox_ru("h"), (Visemes{KK}));
  EXPECT_EQ(visemes_of_festvox_ru("y"), (Visemes{IH}));
  EXPECT_EQ(visemes_of_festvox_ru("rr"), (Visemes{DD}));
  EXPECT_FALSE(visemes_of_festvox_ru("ow"));
  EXPECT_TRUE(is_bilabial_stop("p") && is_bilabial_stop("b") && is_bilabial_stop("pp") &&
              is_bilabial_stop("ɓ"));
  EXPECT_FALSE(is_bilabial_stop("m") || is_bilabial_stop("em") || is_bilabial_stop("mm") ||
               is_bilabial_stop("m̩"));
}

TEST(Closure, WindowsOfEachSource) {
  const auto window = [](PhoneSource source, const char* label, double event = 1.0) {
    const PhoneSegment segment{.start_s = 1, .end_s = 1.1, .label = label, .visemes = {PP}};
    return closure_window(source, segment, event).value();
  };
  const auto expect = [](const TimeSpan& got, double start, double end) {
    EXPECT_NEAR(got.start_s, start, 1e-9);
    EXPECT_NEAR(got.end_s, end, 1e-9);
  };
  expect(window(PhoneSource::espeak, "p", 1.06), 1.0, 1.064);
  expect(window(PhoneSource::espeak, "p", 1.0), 0.95, 1.004);
  expect(window(PhoneSource::espeak, "b"), 1.004, 1.065);
  expect(window(PhoneSource::espeak, "m"), 1.006, 1.088);
  expect(window(PhoneSource::statistical, "p"), 1.008, 1.075);
  expect(window(PhoneSource::hts, "p"), 1.008, 1.055);
  expect(window(PhoneSource::hts, "b"), 1.008, 1.075);
  expect(window(PhoneSource::hts, "m"), 1.008, 1.088);
  expect(window(PhoneSource::diphone, "b"), 1.010, 1.072);
  expect(window(PhoneSource::diphone, "m"), 1.008, 1.090);
  expect(window(PhoneSource::festvox_ru, "pp"), 1.005, 1.075);
  expect(window(PhoneSource::festvox_ru, "mm"), 1.015, 1.080);
  const PhoneSegment vowel{.start_s = 1, .end_s = 1.1, .label = "aa", .visemes = {AA}};
  EXPECT_FALSE(closure_window(PhoneSource::espeak, vowel, 1));
}

TEST(Emotion, ProsodyIsLinearInIntensity) {
  EXPECT_EQ(prosody_of(Emotion::neutral, 1).pitch_range, 1);
  const Prosody half = prosody_of(Emotion::sad, 0.5), full = prosody_of(Emotion::sad, 1);
  EXPECT_DOUBLE_EQ(full.rate_percent, -16);
  EXPECT_DOUBLE_EQ(half.rate_percent, -8);
  EXPECT_DOUBLE_EQ(half.pitch_range, 0.775);
  EXPECT_DOUBLE_EQ(prosody_of(Emotion::fear, 1).tremor_percent, 2);
  for (int e = 0; e < kNumEmotions; ++e)
    EXPECT_EQ(parse_emotion(name_of(static_cast<Emotion>(e))), static_cast<Emotion>(e));
  EXPECT_FALSE(parse_emotion("glad"));
}

TEST(Speaker, FixedAndDrawnStayInTheLaws) {
  EXPECT_EQ(find_speaker("S15")->jaw, 0.78);
  EXPECT_EQ(find_speaker("S00")->blinks_per_minute, 25.5);
  EXPECT_EQ(find_speaker("S16"), nullptr);
  EXPECT_EQ(fixed_speakers()[11].id, "S11");
  Rng rng(1);
  double blinks = 0;
  int mirrored = 0;
  for (int i = 0; i < 2000; ++i) {
    const Speaker s = draw_speaker(rng);
    ASSERT_GE(s.jaw, 0.65);
    ASSERT_LE(s.jaw, 1.45);
    ASSERT_GE(s.blinks_per_minute, 8);
    ASSERT_LE(s.blinks_per_minute, 32);
    ASSERT_LE(std::abs(s.asymmetry), 0.18);
    blinks += s.blinks_per_minute / 2000;
    mirrored += s.mirror_contempt;
  }
  EXPECT_NEAR(blinks, 18.7, 0.6);
  EXPECT_NEAR(mirrored / 2000.0, 0.5, 0.04);
}

}  // namespace
}  // namespace mien
