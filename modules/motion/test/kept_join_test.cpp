#include "mien/motion/kept_join.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "mien/base/random.h"

namespace mien {
namespace {

using Curve = std::function<double(std::int64_t n)>;

Motion motion_of(const std::vector<std::pair<std::string, Curve>>& channels, std::int64_t num_frames = 120,
                 MotionSpace space = MotionSpace::arkit) {
  Motion motion{space, {}, 60, {}};
  for (const auto& [name, curve] : channels) motion.channels.push_back(name);
  for (std::int64_t n = 0; n < num_frames; ++n)
    for (const auto& [name, curve] : channels) motion.values.push_back(static_cast<float>(curve(n)));
  return motion;
}

double wave(std::int64_t n) { return 0.4 + 0.3 * std::sin(static_cast<double>(n) * 0.15); }
double slow(std::int64_t n) { return 0.3 + 0.1 * std::cos(static_cast<double>(n) * 0.1); }
double at(const Motion& motion, std::int64_t n, std::size_t c = 0) {
  return static_cast<double>(motion.frame(n)[c]);
}
double acceleration(const Motion& motion, std::int64_t n, std::size_t c = 0) {
  return std::abs(at(motion, n - 1, c) - 2 * at(motion, n, c) + at(motion, n + 1, c));
}

KeptValues outside(const Motion& motion, std::int64_t first, std::int64_t end) {
  KeptValues kept(motion);
  const FrameRange stretch{first, end};
  kept.keep_outside({&stretch, 1});
  return kept;
}

TEST(JoinKept, KeepsBitsAndMeetsValueAndVelocity) {
  const Motion motion = motion_of({{"mouthSmileLeft", wave}});
  const KeptValues kept = outside(motion, 40, 80);
  Motion made = motion_of({{"mouthSmileLeft", slow}});
  join_kept(kept, made);
  for (std::int64_t n = 0; n < 120; ++n)
    if (n < 40 || n >= 80) {
      EXPECT_EQ(made.values[static_cast<std::size_t>(n)], motion.values[static_cast<std::size_t>(n)]) << n;
    }
  // The curves accelerate by up to 0.0068 a frame squared; a fade of 0.25 in 12 frames adds up to 5.8 x 0.25
  // / 12^2.
  for (const std::int64_t n : {38, 39, 40, 41, 78, 79, 80, 81}) EXPECT_LT(acceleration(made, n), 0.0169) << n;
  EXPECT_NEAR(at(made, 59), slow(59), 1e-6) << "beyond the fades it is the model's";
  Motion pasted = motion_of({{"mouthSmileLeft", slow}});
  for (std::int64_t n = 0; n < 120; ++n) kept.paste(n, pasted.frame(n));
  EXPECT_GT(acceleration(pasted, 39) + acceleration(pasted, 40), 0.05) << "a paste alone jumps";
}

// What the model makes may itself be rough at a join.
TEST(JoinKept, EasesWhatIsRoughBesideAJoin) {
  const auto rough = [](std::int64_t n) { return slow(n) + (n == 41 || n == 78 ? 0.02 : 0.0); };
  const Motion motion = motion_of({{"mouthSmileLeft", slow}});
  const KeptValues kept = outside(motion, 40, 80);
  Motion made = motion_of({{"mouthSmileLeft", rough}});
  join_kept(kept, made);
  for (std::int64_t n = 0; n < 120; ++n)
    if (n < 40 || n >= 80) {
      EXPECT_EQ(made.values[static_cast<std::size_t>(n)], motion.values[static_cast<std::size_t>(n)]) << n;
    }
  for (const std::int64_t n : {39, 40, 79, 80}) EXPECT_LT(acceleration(made, n), 0.001) << n;
  for (std::int64_t n = 40; n < 80; ++n) EXPECT_LT(acceleration(made, n), 0.041) << n;
  for (std::int64_t n = 47; n < 73; ++n) EXPECT_EQ(at(made, n), static_cast<float>(slow(n))) << n;
}

// Length of the second difference of some channels.
double acceleration_of(const Motion& motion, std::int64_t n, std::span<const std::size_t> channels) {
  double sum = 0;
  for (const std::size_t c : channels) sum += std::pow(acceleration(motion, n, c), 2);
  return std::sqrt(sum);
}

// Joins of a part of the face are within its 95th percentile, or as rough as the motion was there, whatever
// is made, of any length and at any rate; coefficients stay in 0 ... 1.
TEST(JoinKept, JoinsAreWithinTheMotionsOwnAccelerations) {
  const std::vector<std::vector<std::string>> parts = {{"jawOpen", "mouthClose", "mouthSmileLeft"},
                                                       {"eyeBlinkLeft", "browInnerUp"},
                                                       {"eyeLookUpLeft", "eyeLookInLeft"},
                                                       {"headYaw", "headPitch"}};
  Rng rng(11);
  int num_joins = 0, num_at_limit = 0;
  for (int round = 0; round < 60; ++round) {
    const bool is_mesh = round % 3 == 2;
    std::vector<std::pair<std::string, Curve>> old_curves, new_curves;
    std::vector<std::vector<std::size_t>> members;
    for (const auto& names : parts) {
      if (!is_mesh || members.empty()) members.emplace_back();
      for (const std::string& name : names) {
        members.back().push_back(old_curves.size());
        const auto curve = [&](double noise) {
          std::vector<double> values;
          const double speed = rng.uniform(0.05, 0.3), phase = rng.uniform(0, 6);
          for (int n = 0; n < 120; ++n)
            values.push_back(
                std::clamp(0.5 + 0.6 * std::sin(speed * n + phase) + rng.normal(0, noise), 0.0, 1.0));
          return [values](std::int64_t n) { return values[static_cast<std::size_t>(n)]; };
        };
        // Some channels are still, as lids that do not blink.
        const bool is_still = rng.chance(0.2);
        old_curves.emplace_back(name, is_still ? Curve([](std::int64_t) { return 0.0; }) : curve(0.002));
        new_curves.emplace_back(name, curve(0.05));
      }
    }
    const MotionSpace space = is_mesh ? MotionSpace::vertices : MotionSpace::arkit;
    Motion motion = motion_of(old_curves, 120, space), made = motion_of(new_curves, 120, space);
    if (is_mesh) motion.channels.clear(), made.channels.clear();
    motion.fps = made.fps = round % 2 == 0 ? 60 : 25;
    if (is_mesh) motion.topology.num_vertices = made.topology.num_vertices = 3;
    const auto length = static_cast<std::int64_t>(4 + rng.below(40));
    const auto first = static_cast<std::int64_t>(2 + rng.below(static_cast<std::uint64_t>(116 - length)));
    join_kept(outside(motion, first, first + length), made);
    for (const auto& channels : members) {
      std::vector<double> all;
      for (std::int64_t n = 1; n < 119; ++n) all.push_back(acceleration_of(motion, n, channels));
      auto sorted = all;
      std::ranges::sort(sorted);
      const double usual = sorted[static_cast<std::size_t>(0.95 * 117)];
      for (const std::int64_t n : {first - 1, first, first + length - 1, first + length}) {
        ++num_joins;
        const double limit = std::max(usual, all[static_cast<std::size_t>(n - 1)]);
        EXPECT_LE(acceleration_of(made, n, channels), limit + 5e-7)
            << "round " << round << " frame " << n << " of " << first << "-" << first + length;
        num_at_limit += acceleration_of(made, n, channels) > 0.8 * limit;
      }
    }
    for (std::int64_t n = 0; n < 120; ++n)
      for (std::size_t c = 0; c < old_curves.size(); ++c) {
        const bool is_kept = n < first || n >= first + length;
        if (is_kept) {
          EXPECT_EQ(made.frame(n)[c], motion.frame(n)[c]);
        }
        if (!is_mesh && !old_curves[c].first.starts_with("head")) {
          EXPECT_GE(made.frame(n)[c], 0);
          EXPECT_LE(made.frame(n)[c], 1);
        }
      }
  }
  EXPECT_GT(num_at_limit, num_joins / 4) << "what is made is rough: many joins are held at their limit";
}

// Nothing accelerates in the motion: two frames go on as the kept ones move, and what is made begins behind
// them.
TEST(JoinKept, WhatTheMotionHoldsStillIsLeftGently) {
  const Motion motion = motion_of({{"eyeBlinkLeft", [](std::int64_t) { return 0.25; }}});
  Motion made = motion_of({{"eyeBlinkLeft", [](std::int64_t n) { return n % 2 == 0 ? 0.9 : 0.6; }}});
  join_kept(outside(motion, 40, 80), made);
  for (const std::int64_t n : {39, 40, 79, 80}) EXPECT_EQ(acceleration(made, n), 0) << n;
  for (const std::int64_t n : {40, 41, 78, 79}) EXPECT_EQ(at(made, n), 0.25) << n;
  EXPECT_GT(at(made, 45), 0.26);
  EXPECT_EQ(at(made, 60), static_cast<double>(0.9f)) << "beyond the fade it is the model's";
}

TEST(JoinKept, DoesNotTouchWhatIsSmoothBesideAJoin) {
  const Motion motion = motion_of({{"mouthSmileLeft", wave}});
  Motion made = motion_of({{"mouthSmileLeft", wave}});
  join_kept(outside(motion, 40, 80), made);
  EXPECT_EQ(made.values, motion.values);
}

TEST(JoinKept, ShortStretchesFadeWithinThemselves) {
  const Motion motion = motion_of({{"headYaw", [](std::int64_t n) { return static_cast<double>(n) / 10; }}});
  for (const std::int64_t length : {1, 2, 5}) {
    const KeptValues kept = outside(motion, 60, 60 + length);
    Motion made = motion_of({{"headYaw", [](std::int64_t) { return -20.0; }}});
    join_kept(kept, made);
    for (std::int64_t n = 0; n < 120; ++n) {
      EXPECT_TRUE(std::isfinite(made.values[static_cast<std::size_t>(n)]));
      if (n < 60 || n >= 60 + length) {
        EXPECT_EQ(made.values[static_cast<std::size_t>(n)], motion.values[static_cast<std::size_t>(n)]);
      }
    }
  }
}

TEST(JoinKept, MeetsSingleKeys) {
  const Motion motion = motion_of({{"browInnerUp", slow}});
  KeptValues kept(motion);
  kept.set(60, 0, 0.9f);
  kept.set(0, 0, 0);
  kept.set(119, 0, 0.5f);
  Motion made = motion_of({{"browInnerUp", slow}});
  join_kept(kept, made);
  EXPECT_EQ(made.values[60], 0.9f);
  EXPECT_EQ(made.values[0], 0);
  EXPECT_EQ(made.values[119], 0.5f);
  EXPECT_LT(acceleration(made, 60), 0.01);
  EXPECT_NEAR(at(made, 30), slow(30), 1e-6);
}

TEST(JoinKept, StaysInTheRangeOfCoefficients) {
  const Motion motion = motion_of(
      {{"mouthSmileLeft", [](std::int64_t n) { return n < 40 ? 0.025 * static_cast<double>(n) : 1.0; }},
       {"headYaw", [](std::int64_t n) { return static_cast<double>(n); }}});
  const KeptValues kept = outside(motion, 39, 90);
  Motion made = motion_of(
      {{"mouthSmileLeft", [](std::int64_t) { return 0.9; }}, {"headYaw", [](std::int64_t) { return 0.0; }}});
  join_kept(kept, made);
  double highest_yaw = 0;
  for (std::int64_t n = 0; n < 120; ++n) {
    EXPECT_LE(at(made, n), 1) << n;
    highest_yaw = std::max(highest_yaw, at(made, n, 1));
  }
  EXPECT_GT(highest_yaw, 1) << "angles have no such range";
}

// A model's jaw and lips with a closure from frame 58 to 62.
double model_jaw(std::int64_t) { return 0.3; }
double model_close(std::int64_t n) { return n >= 58 && n <= 62 ? 0.32 : 0.0; }
double model_lift(std::int64_t n) { return n >= 58 && n <= 62 ? 0.0 : 0.2; }

TEST(JoinKept, ClosuresStaySealedWhateverJawIsKept) {
  for (const double kept_jaw : {0.0, 0.1, 0.6}) {
    const Motion motion = motion_of({{"jawOpen", [&](std::int64_t) { return kept_jaw; }},
                                     {"mouthClose", [](std::int64_t) { return 0.0; }},
                                     {"mouthUpperUpLeft", [](std::int64_t) { return 0.5; }}});
    KeptValues kept(motion);
    kept.keep_channel(0);
    Motion made =
        motion_of({{"jawOpen", model_jaw}, {"mouthClose", model_close}, {"mouthUpperUpLeft", model_lift}});
    join_kept(kept, made);
    for (std::int64_t n = 58; n <= 62; ++n) {
      EXPECT_LE(at(made, n, 0) - at(made, n, 1), 1e-6) << kept_jaw << " " << n;
      EXPECT_NEAR(at(made, n, 2), 0, 1e-6);
    }
    EXPECT_NEAR(at(made, 30, 2), 0.2, 1e-6);
  }
}

TEST(JoinKept, ALockedMouthCloseIsSealedByTheJaw) {
  const Motion motion = motion_of({{"jawOpen", model_jaw}, {"mouthClose", [](std::int64_t) { return 0.1; }}});
  KeptValues kept(motion);
  kept.keep_channel(1);
  Motion made = motion_of({{"jawOpen", model_jaw}, {"mouthClose", model_close}});
  join_kept(kept, made);
  for (std::int64_t n = 58; n <= 62; ++n) EXPECT_LE(at(made, n, 0) - at(made, n, 1), 1e-6) << n;
  EXPECT_NEAR(at(made, 30, 0), 0.3, 1e-6);
}

TEST(JoinKept, ClosuresWithinAFadeSealToo) {
  const Motion motion = motion_of(
      {{"jawOpen", [](std::int64_t) { return 0.8; }}, {"mouthClose", [](std::int64_t) { return 0.0; }}});
  const KeptValues kept = outside(motion, 52, 100);  // the fade of the jaw lasts to frame 63
  Motion made = motion_of({{"jawOpen", model_jaw}, {"mouthClose", model_close}});
  join_kept(kept, made);
  EXPECT_GT(at(made, 58, 0), 0.32);
  for (std::int64_t n = 58; n <= 62; ++n) EXPECT_LE(at(made, n, 0) - at(made, n, 1), 1e-6) << n;
}

TEST(JoinKept, TakesNothingEverythingAndNoFrames) {
  const Motion motion = motion_of({{"jawOpen", wave}, {"mouthClose", slow}});
  Motion made = motion_of({{"jawOpen", slow}, {"mouthClose", [](std::int64_t) { return 0.0; }}});
  const Motion before = made;
  join_kept(KeptValues(motion), made);
  EXPECT_EQ(made.values, before.values) << "nothing is kept: what the model made stays";
  join_kept(outside(motion, 0, 0), made);
  EXPECT_EQ(made.values, motion.values);
  Motion none = motion_of({{"jawOpen", wave}}, 0);
  join_kept(KeptValues(none), none);
  EXPECT_EQ(none.num_frames(), 0);
  Motion narrow = motion_of({{"jawOpen", wave}});
  EXPECT_THROW(join_kept(KeptValues(motion), narrow), std::logic_error);
}

}  // namespace
}  // namespace mien
