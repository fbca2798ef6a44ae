#include "mien/metrics/contact.h"

#include <gtest/gtest.h>

#include <cmath>

#include "labels_for_tests.h"
#include "mien/core/arkit.h"
#include "mien/metrics/jaw_energy.h"
#include "mien/metrics/loudness.h"

namespace mien {
namespace {

using test::make_labels;

// 1 s silence, 1 s vowel, 1 s silence.
const SpeechLabels kLabels = make_labels({{"sil", 1}, {"aa", 1}, {"sil", 1}});

Aperture triangle_in_speech(double pause_step) {
  Aperture a;
  for (int n = 0; n < 180; ++n) a.values.push_back(n >= 60 && n < 120 ? 0.3 * (n % 2) : pause_step * (n % 2));
  return a;
}

TEST(Contact, PausesLeaveOutSettlingAndPreparing) {
  const auto pause = pause_frames(kLabels, 180);
  EXPECT_FALSE(pause[8]);  // 133 ms
  EXPECT_TRUE(pause[9]);   // 150 ms
  EXPECT_TRUE(pause[54]);  // 900 ms
  EXPECT_FALSE(pause[55]);
  EXPECT_FALSE(pause[90]);
  SpeechLabels noisy = kLabels;
  noisy.rows[0].flags = kNotQuiet;
  noisy.rows[2].confidence = 0.6;
  for (const bool p : pause_frames(noisy, 180)) EXPECT_FALSE(p);
}

TEST(Contact, PauseMotionIsTheRatioOfMeanSpeeds) {
  const RestScore s = score_rest(triangle_in_speech(0.03), kLabels, nullptr);
  EXPECT_NEAR(s.pause_speed.value(), 0.03 * 60, 1e-9);
  EXPECT_NEAR(s.phone_speed.value(), 0.3 * 60, 0.3);  // its first step comes from the pause
  EXPECT_NEAR(s.pause_motion_ratio(), 0.1, 0.002);
  EXPECT_NEAR(s.mean_pause_aperture(), 0.015 / 0.3, 0.002);
  EXPECT_EQ(s.closed_at_end, 1);
  EXPECT_NEAR(score_rest(triangle_in_speech(0), kLabels, nullptr).pause_motion_ratio(), 0, 1e-12);
}

TEST(Contact, OpenEndIsSeen) {
  Aperture a = triangle_in_speech(0);
  a.values.back() = 0.2;
  RestScore s = score_rest(a, kLabels, nullptr);
  s += score_rest(triangle_in_speech(0), kLabels, nullptr);
  EXPECT_DOUBLE_EQ(s.closed_at_end_share(), 0.5);
}

TEST(Contact, MouthCurvesCountTwentySeven) {
  Motion motion{MotionSpace::arkit, arkit_and_head_channels(), 60, std::vector<float>(180 * 55, 0.f)};
  for (std::int64_t n = 0; n < 180; ++n) {
    motion.frame(n)[arkit_index("mouthSmileLeft")] = static_cast<float>(n % 2);
    motion.frame(n)[arkit_index("browInnerUp")] = static_cast<float>(n % 3);  // not a mouth curve
  }
  const RestScore s = score_rest(triangle_in_speech(0), kLabels, &motion);
  EXPECT_NEAR(s.mouth_pause_speed.value(), 60.0 / 27, 1e-6);
  EXPECT_NEAR(s.mouth_pause_motion_ratio(), 1, 1e-9);
  for (std::int64_t n = 0; n < 180; ++n)
    motion.frame(n)[arkit_index("mouthSmileRight")] = 1 - static_cast<float>(n % 2);
  const RestScore cancelled = score_rest(triangle_in_speech(0), kLabels, &motion);
  EXPECT_NEAR(cancelled.mouth_pause_speed.value(), 0, 1e-6);
  EXPECT_NEAR(cancelled.curve_pause_speed.value(), 2 * 60.0 / 27, 1e-6);
}

TEST(Contact, StillnessOfSilence) {
  const StillnessScore s = score_stillness({ApertureVariant::curves, {0, 0.1, 0, 0}});
  EXPECT_DOUBLE_EQ(s.mean_aperture, 0.025);
  EXPECT_DOUBLE_EQ(s.largest_aperture, 0.1);
  EXPECT_NEAR(s.mean_speed, 0.2 * 60 / 3, 1e-9);
  EXPECT_EQ(s.last_aperture, 0);
  EXPECT_EQ(score_stillness({}).mean_speed, 0);
}

TEST(Contact, NothingToScoreIsNaN) {
  EXPECT_TRUE(std::isnan(score_rest({}, kLabels, nullptr).pause_motion_ratio()));
  EXPECT_TRUE(std::isnan(score_rest(triangle_in_speech(0), {}, nullptr).mean_pause_aperture()));
}

std::vector<double> wave(double delay_frames) {
  std::vector<double> out;
  for (int n = 0; n < 180; ++n) {
    const double x = n - delay_frames;
    out.push_back(std::sin(x * 0.31) + 0.5 * std::sin(x * 0.123 + 1));
  }
  return out;
}

TEST(JawEnergy, FollowsTheDelayOfTheJaw) {
  const SpeechLabels labels = make_labels({{"aa", 3}});
  const auto level = smooth_30_ms(wave(0));
  const JawEnergy same = jaw_energy(wave(0), level, labels);
  EXPECT_NEAR(same.r(), 1, 1e-9);
  EXPECT_EQ(same.frames, 180);
  const PooledJawEnergy late = pool_jaw_energy(std::vector<JawEnergy>{jaw_energy(wave(3), level, labels)});
  EXPECT_NEAR(late.lag_ms, 50, 1e-9);
  EXPECT_LT(late.r, 0.8);
  EXPECT_NEAR(pool_jaw_energy(std::vector<JawEnergy>{jaw_energy(wave(-2), level, labels)}).lag_ms, -100.0 / 3,
              1e-9);
}

TEST(JawEnergy, UsesFramesInAndNearPhonesOnly) {
  const JawEnergy e = jaw_energy(wave(0), wave(0), kLabels);
  EXPECT_EQ(e.frames, 60 + 6 + 7);  // 0.9 ... 2.1 s, both ends in
  EXPECT_TRUE(std::isnan(jaw_energy(wave(0), wave(0), make_labels({{"sil", 3}})).r()));
  EXPECT_TRUE(std::isnan(jaw_energy(std::vector<double>(180, 0.2), wave(0), kLabels).r()));
}

TEST(Loudness, LevelOfAToneAndItsFloor) {
  std::vector<float> samples(16000, 0.f);
  for (std::size_t i = 8000; i < 16000; ++i)
    samples[i] = static_cast<float>(0.5 * std::sin(0.3 * static_cast<double>(i)));
  const auto level = speech_level_db(samples);
  ASSERT_EQ(level.size(), 60u);
  EXPECT_NEAR(level[50], 10 * std::log10(0.125), 0.1);
  EXPECT_NEAR(level[5], 10 * std::log10(0.125) - 35, 0.2);
  const auto e = loudness(level);
  EXPECT_NEAR(e[50], 1, 0.01);
  EXPECT_EQ(e[5], 0);
  EXPECT_TRUE(speech_level_db({}).empty());
  EXPECT_EQ(speech_level_db(std::vector<float>(200, 0.f)).size(), 1u);
}

TEST(Aperture, VariantsOfOneFrame) {
  const Motion motion{MotionSpace::arkit,
                      {"jawOpen", "mouthClose", "mouthPressLeft", "mouthPressRight"},
                      60,
                      {0.5f, 0.25f, 0.25f, 0.5f}};
  EXPECT_DOUBLE_EQ(curve_aperture(motion, ApertureVariant::curves)->values[0], 0.25);
  EXPECT_DOUBLE_EQ(curve_aperture(motion, ApertureVariant::press)->values[0], -0.125);
  EXPECT_FALSE(curve_aperture({MotionSpace::arkit, {"jawOpen"}, 60, {0.5f}}, ApertureVariant::curves));
  Motion broken = motion;
  broken.values[1] = std::nanf("");
  const auto refused = at_metric_rate(broken);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message().find("mouthClose"), std::string::npos);
  broken.fps = 0;
  EXPECT_FALSE(at_metric_rate(broken));
}

TEST(Aperture, MeshGapIsInMillimetresAboveNeutral) {
  const std::vector<Vec3> neutral = {{0, 0.001f, 0}, {0, 0, 0}};
  const Motion motion = vertex_motion({"lips", 2}, 60, {0, 0.002f, 0, 0, -0.002f, 0});
  const auto gap = mesh_aperture(motion, neutral, {0, 1});
  ASSERT_TRUE(gap);
  EXPECT_NEAR(gap->values[0], 3, 1e-4);
  EXPECT_FALSE(mesh_aperture(motion, neutral, {0, 2}));
  EXPECT_FALSE(mesh_aperture({MotionSpace::arkit, {"jawOpen"}, 60, {0}}, neutral, {0, 1}));
}

}  // namespace
}  // namespace mien
