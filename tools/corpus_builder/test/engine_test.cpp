#include "engine.h"

#include <gtest/gtest.h>

#include <cmath>

#include "clip.h"

namespace mien {
namespace {

constexpr const char* kText = "Bob's baby popped a purple map.";

void expect_contiguous(const Sentence& s) {
  ASSERT_FALSE(s.phones.empty());
  EXPECT_EQ(s.phones.front().start, 0.0);
  for (std::size_t i = 1; i < s.phones.size(); ++i) {
    EXPECT_NEAR(s.phones[i].start, s.phones[i - 1].end, 1e-9) << i;
    EXPECT_GT(s.phones[i].end, s.phones[i].start) << i;
  }
  EXPECT_NEAR(s.phones.back().end, static_cast<double>(s.samples.size()) / s.sample_rate_hz, 1e-6);
}

double seconds(const Sentence& s) { return static_cast<double>(s.samples.size()) / s.sample_rate_hz; }

#define MIEN_NEED_ENGINE(name, id)      \
  Engine* const name = find_engine(id); \
  if (name == nullptr) GTEST_SKIP() << engine_name(id) << " is absent"

TEST(Espeak, MovesTheSilenceBeforeAStopIntoIt) {
  MIEN_NEED_ENGINE(espeak, EngineId::espeak);
  const auto s = espeak->synthesise(kText, "gmw/en-US", {});
  ASSERT_TRUE(s.has_value()) << s.error().message();
  EXPECT_EQ(s->sample_rate_hz, 22050);
  expect_contiguous(*s);
  int repaired = 0;
  for (const auto& phone : s->phones) {
    if (!phone.burst) continue;
    ++repaired;
    EXPECT_GE(*phone.burst - phone.start, 0.008) << phone.label;
    EXPECT_LE(*phone.burst - phone.start, 0.151) << phone.label;
    for (auto i = static_cast<std::size_t>(std::ceil(phone.start * s->sample_rate_hz));
         i + 1 < static_cast<std::size_t>(*phone.burst * s->sample_rate_hz); ++i)
      ASSERT_LT(std::abs(s->samples[i]), 2e-4f) << phone.label;
  }
  EXPECT_GE(repaired, 4);  // p of popped (twice), purple, map; t of popped
}

TEST(Espeak, RefusesVoicesThatItWouldSilentlyReplace) {
  MIEN_NEED_ENGINE(espeak, EngineId::espeak);
  for (const char* voice : {"gmw/en-US+nobody", "en-gb", "", "gmw/en-US+"}) {
    const auto s = espeak->synthesise(kText, voice, {});
    ASSERT_FALSE(s.has_value()) << voice;
    EXPECT_EQ(s.error().code, Errc::usage) << voice;
  }
}

TEST(Espeak, ReadsMarkupCharactersAndOtherLanguages) {
  MIEN_NEED_ENGINE(espeak, EngineId::espeak);
  EXPECT_TRUE(espeak->synthesise("Salt & pepper < sugar > milk.", "gmw/en-US", {}).has_value());
  const auto s = espeak->synthesise("popa museki boto", "roa/fr+f2", {});
  ASSERT_TRUE(s.has_value());
  for (const auto& phone : s->phones) EXPECT_FALSE(phone.label.starts_with('(')) << phone.label;
  const auto phones = espeak->phones_of("a map", "gmw/en-US");
  EXPECT_EQ(phones.size(), 4u);
}

TEST(Espeak, ObeysRateAndPitch) {
  MIEN_NEED_ENGINE(espeak, EngineId::espeak);
  const auto slow = espeak->synthesise(kText, "gmw/en-US", {0.7, 0, 1});
  const auto fast = espeak->synthesise(kText, "gmw/en-US", {1.4, 0, 1});
  ASSERT_TRUE(slow.has_value() && fast.has_value());
  EXPECT_GT(seconds(*slow), 1.3 * seconds(*fast));
}

TEST(Flite, SpeaksWithAllItsVoices) {
  MIEN_NEED_ENGINE(flite, EngineId::flite);
  EXPECT_EQ(flite->voices(), (std::vector<std::string>{"awb", "kal16", "rms", "slt"}));
  for (const auto& voice : flite->voices()) {
    const auto s = flite->synthesise(kText, voice, {});
    ASSERT_TRUE(s.has_value()) << voice;
    EXPECT_EQ(s->sample_rate_hz, 16000);
    expect_contiguous(*s);
    const auto slow = flite->synthesise(kText, voice, {0.7, 0, 1});
    ASSERT_TRUE(slow.has_value());
    EXPECT_GT(seconds(*slow), 1.15 * seconds(*s)) << voice;
    const auto again = flite->synthesise(kText, voice, {});
    EXPECT_TRUE(again->samples == s->samples) << voice << ": an earlier speed sticks";
  }
  EXPECT_FALSE(flite->synthesise(kText, "nobody", {}).has_value());
}

TEST(Festival, SpeaksWithAllItsVoices) {
  MIEN_NEED_ENGINE(festival, EngineId::festival);
  for (const auto& voice : festival->voices()) {
    const auto s = festival->synthesise("He said \"stop\", and (so) it was.", voice, {});
    ASSERT_TRUE(s.has_value()) << s.error().message();
    expect_contiguous(*s);
  }
  EXPECT_FALSE(festival->synthesise(kText, "nobody", {}).has_value());
}

TEST(Clip, OfEveryEngineHasClosuresInsideOfTheirNeighbourhood) {
  for (const auto* engine : available_engines()) {
    const std::string voice = engine->id() == EngineId::espeak ? "gmw/en-US" : engine->voices().front();
    const auto clip = speak({engine->id(), voice, kText, {}, Emotion::neutral, 1.0, 0.25, 0.4});
    ASSERT_TRUE(clip.has_value()) << clip.error().message();
    EXPECT_DOUBLE_EQ(clip->spoken.seconds, static_cast<double>(clip->samples.size()) / 16000);
    int bilabials = 0;
    for (const auto& phone : clip->spoken.phones) {
      if (!phone.is_bilabial()) {
        EXPECT_FALSE(phone.closure) << phone.label;
        continue;
      }
      ++bilabials;
      ASSERT_TRUE(phone.closure) << phone.label;
      EXPECT_LT(phone.closure->start_s, phone.closure->end_s);
      EXPECT_GE(phone.closure->start_s, phone.start_s - 0.051);
      EXPECT_LE(phone.closure->end_s, phone.end_s);
    }
    EXPECT_EQ(bilabials, 10) << voice;
    EXPECT_FALSE(clip->spoken.accents_s.empty());
    EXPECT_FALSE(clip->spoken.is_question);
  }
}

TEST(Clip, EmotionChangesTempoAndLevel) {
  MIEN_NEED_ENGINE(espeak, EngineId::espeak);
  const auto neutral = speak({EngineId::espeak, "gmw/en-US", kText, {}, Emotion::neutral, 1.0, 0, 0});
  const auto sad = speak({EngineId::espeak, "gmw/en-US", kText, {}, Emotion::sad, 1.0, 0, 0});
  ASSERT_TRUE(neutral.has_value() && sad.has_value());
  EXPECT_GT(sad->spoken.seconds, 1.08 * neutral->spoken.seconds);
  const auto peak = [](const Clip& c) {
    float p = 0;
    for (const float v : c.samples) p = std::max(p, std::abs(v));
    return p;
  };
  EXPECT_LT(peak(*sad), 0.85f * peak(*neutral));
}

TEST(Clip, JoiningKeepsTimesAndSamplesTogether) {
  const auto make = [](std::size_t count, double phone_at) {
    Clip c{std::vector<float>(count, 0.5f), {}, 1};
    PhoneSegment p;
    p.start_s = phone_at;
    p.end_s = phone_at + 0.01;
    c.spoken.phones.push_back(p);
    c.spoken.seconds = static_cast<double>(count) / 16000;
    return c;
  };
  const auto all = join_clips({make(1601, 0.02), make(333, 0.005), make(16000, 0.5)});
  EXPECT_EQ(all.samples.size(), 17934u);
  EXPECT_DOUBLE_EQ(all.spoken.seconds, 17934.0 / 16000);
  EXPECT_NEAR(all.spoken.phones[2].start_s, (1601 + 333) / 16000.0 + 0.5, 1e-9);
  EXPECT_TRUE(join_clips({}).samples.empty());
}

}  // namespace
}  // namespace mien
