#include "mien/corpus/articulation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "mien/core/arkit.h"
#include "mien/corpus/take.h"
#include "synthetic_utterance.h"

// The checks that the builder must pass (corpus specification, section 4.5), on speech made without a
// synthesiser.
namespace mien {
namespace {

float value(const Motion& motion, std::int64_t n, std::string_view name) {
  return motion.frame(n)[arkit_index(name)];
}
float aperture(const Motion& motion, std::int64_t n) {
  return value(motion, n, "jawOpen") - value(motion, n, "mouthClose");
}
std::int64_t frame_at(double t) { return std::llround(t * kCorpusFps); }

// Smallest aperture within `reach` frames of the centre of a closure.
float closed_aperture(const Motion& motion, const PhoneSegment& phone, std::int64_t reach) {
  const std::int64_t centre = frame_at((phone.closure->start_s + phone.closure->end_s) / 2);
  float least = 1;
  for (std::int64_t n = centre - reach; n <= centre + reach; ++n)
    least = std::min(least, aperture(motion, n));
  return least;
}

TEST(Articulation, EveryBilabialClosesTheLipsInTheDefaultStyle) {
  int num = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Utterance utterance = synthetic_utterance(20, seed);
    const Motion motion = default_performance(utterance);
    for (const PhoneSegment& phone : utterance.phones) {
      if (!phone.is_bilabial()) continue;
      ++num;
      EXPECT_LT(closed_aperture(motion, phone, 1), 0.03f) << phone.label << " at " << phone.start_s << " s";
    }
  }
  EXPECT_GT(num, 300);
}

TEST(Articulation, EveryBilabialClosesTheLipsInEveryTake) {
  Rng rng(7);
  int num = 0;
  for (int i = 0; i < 200; ++i) {
    const Utterance utterance = synthetic_utterance(6, rng.bits());
    const Speaker speaker = draw_speaker(rng);
    const auto emotion = static_cast<Emotion>(rng.below(kNumEmotions));
    const Take take = draw_take(utterance, speaker, emotion,
                                intensity_of_level(1 + static_cast<int>(rng.below(3))), rng.bits());
    for (const PhoneSegment& phone : utterance.phones) {
      if (!phone.is_bilabial()) continue;
      ++num;
      EXPECT_LT(closed_aperture(take.motion, phone, 3), 0.03f)
          << phone.label << " at " << phone.start_s << " s, " << name_of(emotion);
    }
  }
  EXPECT_GT(num, 1000);
}

TEST(Articulation, LabiodentalsTouchTheLip) {
  int num = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Utterance utterance = synthetic_utterance(20, seed);
    const Motion motion = default_performance(utterance);
    for (const PhoneSegment& phone : utterance.phones) {
      if (phone.visemes.first != Viseme::FF) continue;
      ++num;
      EXPECT_GT(value(motion, frame_at((phone.start_s + phone.end_s) / 2), "mouthRollLower"), 0.4f)
          << phone.start_s;
    }
  }
  EXPECT_GT(num, 150);
}

// Largest step between frames over the lower face, and largest second difference of jawOpen.
struct Steps {
  float step = 0, jaw_bend = 0;
};
Steps largest_steps(const Motion& motion) {
  Steps s;
  const auto is_lower = [](std::size_t c) { return (c >= 14 && c <= 40) || (c >= 46 && c <= 51); };
  const std::size_t jaw = arkit_index("jawOpen");
  for (std::int64_t n = 1; n < motion.num_frames(); ++n) {
    const auto a = motion.frame(n - 1), b = motion.frame(n);
    for (std::size_t c = 0; c < kNumArkit; ++c)
      if (is_lower(c)) s.step = std::max(s.step, std::abs(b[c] - a[c]));
    if (n + 1 < motion.num_frames())
      s.jaw_bend = std::max(s.jaw_bend, std::abs(motion.frame(n + 1)[jaw] - 2 * b[jaw] + a[jaw]));
  }
  return s;
}

TEST(Articulation, NothingJumps) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Steps s = largest_steps(default_performance(synthetic_utterance(20, seed)));
    EXPECT_LT(s.step, 0.25f);
    EXPECT_LT(s.jaw_bend, 0.08f);
  }
  Rng rng(8);
  for (int i = 0; i < 100; ++i) {
    const Utterance utterance = synthetic_utterance(6, rng.bits());
    const Speaker speaker = draw_speaker(rng);
    const auto emotion = static_cast<Emotion>(rng.below(kNumEmotions));
    EXPECT_LT(largest_steps(draw_take(utterance, speaker, emotion, 1, rng.bits()).motion).step, 0.35f);
  }
}

struct Mean {
  double sum = 0;
  int num = 0;
  void add(double x) { sum += x, ++num; }
  [[nodiscard]] double value() const { return sum / num; }
};

TEST(Articulation, MouthShapesOfThePhones) {
  std::map<Viseme, Mean> jaw;                                // over all frames of a viseme
  std::map<std::pair<Viseme, std::string_view>, Mean> peak;  // over phones
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    Utterance utterance = synthetic_utterance(20, seed);
    const Motion motion = default_performance(utterance);
    for (const PhoneSegment& phone : utterance.phones) {
      const double split = phone.visemes.second ? phone.start_s + 0.55 * phone.seconds() : phone.end_s;
      std::map<std::string_view, float> most;
      for (std::int64_t n = frame_at(phone.start_s); n < frame_at(phone.end_s); ++n) {
        const bool is_second = n >= frame_at(split);
        jaw[is_second ? *phone.visemes.second : phone.visemes.first].add(value(motion, n, "jawOpen"));
        for (const auto name : {"mouthPucker", "mouthFunnel", "mouthStretchLeft"})
          most[name] = std::max(most[name], value(motion, n, name));
      }
      if (phone.visemes.second) continue;
      for (const auto& [name, v] : most) peak[{phone.visemes.first, name}].add(v);
    }
  }
  const std::pair<Viseme, double> expected[] = {{Viseme::AA, 0.42}, {Viseme::AE, 0.38}, {Viseme::AO, 0.35},
                                                {Viseme::EH, 0.27}, {Viseme::IY, 0.14}, {Viseme::UW, 0.12},
                                                {Viseme::SS, 0.10}, {Viseme::sil, 0.05}};
  for (const auto& [viseme, mean] : expected)
    EXPECT_NEAR(jaw.at(viseme).value(), mean, 0.04) << name_of(viseme);
  EXPECT_GE(peak.at({Viseme::UW, "mouthPucker"}).value(), 0.6);
  EXPECT_GE(peak.at({Viseme::WW, "mouthPucker"}).value(), 0.6);
  EXPECT_GE(peak.at({Viseme::CH, "mouthFunnel"}).value(), 0.45);
  EXPECT_GE(peak.at({Viseme::IY, "mouthStretchLeft"}).value(), 0.2);
}

TEST(Articulation, ShortGapsDoNotRelaxTheMouth) {
  const auto in_gap = [](double gap) {
    const std::vector<PhoneSegment> phones = {
        {.start_s = 0.4, .end_s = 0.5, .label = "uw", .visemes = {Viseme::UW}},
        {.start_s = 0.5, .end_s = 0.5 + gap, .label = "pau", .visemes = {}},
        {.start_s = 0.5 + gap, .end_s = 0.6 + gap, .label = "aa", .visemes = {Viseme::AA}}};
    return articulate(phones, {}, 90)[static_cast<std::size_t>((0.5 + gap / 2) * 60)];
  };
  // A pause that pulls with full strength leaves 0.53 and 0.35.
  EXPECT_NEAR(in_gap(0.05)[Articulator::round], 0.65f, 0.02f);
  EXPECT_NEAR(in_gap(0.05)[Articulator::jaw_open], 0.43f, 0.02f);
  EXPECT_LT(in_gap(0.40)[Articulator::round], 0.05f);
}

TEST(Articulation, AnticipatesAndWidensAsAsked) {
  Utterance u;
  u.seconds = 1;
  u.phones = {{.start_s = 0.5, .end_s = 0.6, .label = "uw", .visemes = {Viseme::UW}}};
  const auto onset = [&](const ArticulationStyle& style) {
    const auto frames = articulate(u.phones, style, 60);
    for (std::size_t n = 0; n < frames.size(); ++n)
      if (frames[n][Articulator::round] > 0.3f) return n;
    return frames.size();
  };
  const std::size_t plain = onset({});
  EXPECT_LT(onset({.width = 1.25}), plain);
  EXPECT_LT(onset({.lead_s = 0.03}), plain);
  EXPECT_THROW(articulate(u.phones, {}, 60, std::vector<double>{1, 1}), std::logic_error);
}

}  // namespace
}  // namespace mien
