#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "clip.h"
#include "mien/audio/log_mel.h"
#include "mien/corpus/text.h"

namespace mien {
namespace {

constexpr double kStep = 0.001;  // seconds

// Mean log energy of the bands that a closure empties, between frames linearly.
class SpeechBands {
 public:
  explicit SpeechBands(const std::vector<float>& samples) {
    const auto mel = log_mel(samples);
    for (std::size_t t = 0; t < mel.values.size() / kNumMelBands; ++t) {
      double sum = 0;
      for (std::size_t b = 9; b <= 48; ++b) sum += mel.values[t * kNumMelBands + b];
      level_.push_back(sum / 40);
    }
  }
  [[nodiscard]] double at(double second) const {
    const double p = std::clamp(second * kMelFrameRateHz, 0.0, static_cast<double>(level_.size()) - 1.001);
    const auto i = static_cast<std::size_t>(p);
    return level_[i] + (p - static_cast<double>(i)) * (level_[i + 1] - level_[i]);
  }

 private:
  std::vector<double> level_;
};

// The stretch around the weakest instant of a phone in which the sound stays below 40 % of its local depth
// (spec section 1.4).
TimeSpan weak_region(const SpeechBands& bands, const PhoneSegment& phone) {
  double lowest = phone.start_s;
  for (double t = phone.start_s - 0.03; t <= phone.end_s + 0.02; t += kStep)
    if (bands.at(t) < bands.at(lowest)) lowest = t;
  double left = -1e9, right = -1e9;
  for (double d = 0; d < 0.15; d += kStep) {
    left = std::max(left, bands.at(lowest - d));
    right = std::max(right, bands.at(lowest + d));
  }
  const double limit = bands.at(lowest) + 0.4 * (std::min(left, right) - bands.at(lowest));
  TimeSpan weak{lowest, lowest};
  while (weak.start_s > lowest - 0.15 && bands.at(weak.start_s) < limit) weak.start_s -= kStep;
  while (weak.end_s < lowest + 0.15 && bands.at(weak.end_s) < limit) weak.end_s += kStep;
  return weak;
}

double median(std::vector<double> v) {
  std::sort(v.begin(), v.end());
  return v[v.size() / 2];
}

class ClosureAlignment : public testing::TestWithParam<std::pair<EngineId, const char*>> {};

TEST_P(ClosureAlignment, ClosuresLieWhereTheSoundIsWeak) {
  const auto [engine, voice] = GetParam();
  if (find_engine(engine) == nullptr) GTEST_SKIP() << engine_name(engine) << " is absent";
  std::vector<double> start_errors, end_errors;
  for (const auto text : fixed_sentences().first(40)) {
    const auto clip = speak({engine, voice, std::string(text), {}, Emotion::neutral, 1.0, 0.2, 0.2});
    ASSERT_TRUE(clip.has_value()) << clip.error().message();
    const SpeechBands bands(clip->samples);
    const auto& phones = clip->spoken.phones;
    for (std::size_t i = 1; i + 1 < phones.size(); ++i) {
      if (!phones[i].closure || !is_vowel(phones[i - 1].visemes.first) ||
          !is_vowel(phones[i + 1].visemes.first))
        continue;
      const auto weak = weak_region(bands, phones[i]);
      start_errors.push_back(phones[i].closure->start_s - weak.start_s);
      end_errors.push_back(phones[i].closure->end_s - weak.end_s);
    }
  }
  ASSERT_GT(start_errors.size(), 15u);
  EXPECT_NEAR(median(start_errors), 0, 0.010);
  EXPECT_NEAR(median(end_errors), 0, 0.020);
}

INSTANTIATE_TEST_SUITE_P(Voices, ClosureAlignment,
                         testing::Values(std::pair{EngineId::espeak, "gmw/en-US"},
                                         std::pair{EngineId::espeak, "gmw/en+f3"},
                                         std::pair{EngineId::flite, "kal16"},
                                         std::pair{EngineId::flite, "awb"}, std::pair{EngineId::flite, "rms"},
                                         std::pair{EngineId::flite, "slt"}));

}  // namespace
}  // namespace mien
