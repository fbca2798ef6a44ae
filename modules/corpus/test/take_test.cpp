#include "mien/corpus/take.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "mien/core/arkit.h"
#include "synthetic_utterance.h"

namespace mien {
namespace {

const Speaker& speaker(std::string_view id) { return *find_speaker(id); }

bool in_range(const Motion& motion) {
  for (std::int64_t n = 0; n < motion.num_frames(); ++n) {
    const auto frame = motion.frame(n);
    for (std::size_t c = 0; c < frame.size(); ++c) {
      if (!std::isfinite(frame[c])) return false;
      if (c < kNumArkit && (frame[c] < 0 || frame[c] > 1)) return false;
      if (c >= kNumArkit && std::abs(frame[c]) > 45) return false;
    }
  }
  return true;
}

TEST(Take, HasTheRightShapeAndRange) {
  const Utterance utterance = synthetic_utterance(10, 1);
  for (int s = 0; s < kNumFixedSpeakers; ++s)
    for (int e = 0; e < kNumEmotions; ++e) {
      const Take take = draw_take(utterance, fixed_speakers()[s], static_cast<Emotion>(e), 1, 77);
      ASSERT_EQ(take.motion.num_frames(), num_motion_frames(utterance.seconds, 60));
      ASSERT_EQ(take.motion.channels, arkit_and_head_channels());
      ASSERT_TRUE(in_range(take.motion)) << s << " " << e;
      ASSERT_TRUE(in_range(take.without_blinks)) << s << " " << e;
    }
}

TEST(Take, WithBlinksIsTheOtherWithBlinksApplied) {
  const Utterance utterance = synthetic_utterance(30, 2);
  for (int e = 0; e < kNumEmotions; ++e) {
    const Take take = draw_take(utterance, speaker("S06"), static_cast<Emotion>(e), 0.65, 5);
    ASSERT_FALSE(take.blinks.empty());
    Motion motion = take.without_blinks;
    ASSERT_NE(motion.values, take.motion.values);
    apply_blinks(motion, take.blinks);
    EXPECT_EQ(motion.values, take.motion.values);
  }
}

TEST(Take, RaisesAreWhatWithoutEventsLacks) {
  const Utterance utterance = synthetic_utterance(30, 4);
  const Take take = draw_take(utterance, speaker("S02"), Emotion::neutral, 1, 6);
  ASSERT_FALSE(take.raises.empty());
  std::vector<bool> near_a_raise(static_cast<std::size_t>(take.motion.num_frames()), false);
  for (const BrowGesture& raise : take.raises)
    for (std::size_t n = 0; n < near_a_raise.size(); ++n)
      if (std::abs(static_cast<double>(n) / 60 - raise.centre_s) < 0.80) near_a_raise[n] = true;
  const std::size_t brow = arkit_index("browInnerUp"), outer = arkit_index("browOuterUpLeft"),
                    outer_right = arkit_index("browOuterUpRight");
  bool any_frame_without = false;
  for (std::int64_t n = 0; n < take.motion.num_frames(); ++n) {
    const auto with = take.without_blinks.frame(n), without = take.without_events.frame(n);
    for (std::size_t c = 0; c < with.size(); ++c) {
      const bool may_differ =
          (c == brow || c == outer || c == outer_right) && near_a_raise[static_cast<std::size_t>(n)];
      if (may_differ) continue;
      ASSERT_EQ(with[c], without[c]) << n << " " << take.motion.channels[c];
    }
    any_frame_without = any_frame_without || !near_a_raise[static_cast<std::size_t>(n)];
  }
  EXPECT_TRUE(any_frame_without);
  for (const BrowGesture& raise : take.raises) {
    const auto n = std::min(static_cast<std::int64_t>(raise.centre_s * 60), take.motion.num_frames() - 1);
    EXPECT_GT(take.without_blinks.frame(n)[brow], take.without_events.frame(n)[brow] + 0.5 * raise.amplitude);
  }
}

TEST(Take, SameSeedSameBytesOtherSeedOtherTake) {
  const Utterance utterance = synthetic_utterance(8, 3);
  const Take a = draw_take(utterance, speaker("S03"), Emotion::happy, 1, 11);
  const Take b = draw_take(utterance, speaker("S03"), Emotion::happy, 1, 11);
  const Take c = draw_take(utterance, speaker("S03"), Emotion::happy, 1, 12);
  EXPECT_EQ(a.motion.values, b.motion.values);
  EXPECT_NE(a.motion.values, c.motion.values);
  EXPECT_NE(take_seed(1, "a", 0), take_seed(1, "a", 1));
  EXPECT_NE(take_seed(1, "a", 0), take_seed(2, "a", 0));
  EXPECT_NE(take_seed(1, "a", 0), take_seed(1, "b", 0));
}

TEST(Take, ProcessesAreIndependent) {
  Utterance utterance = synthetic_utterance(8, 4);
  const Take before = draw_take(utterance, speaker("S01"), Emotion::neutral, 1, 21);
  utterance.accents_s.clear();  // brows and nods change, nothing else does
  const Take after = draw_take(utterance, speaker("S01"), Emotion::neutral, 1, 21);
  const auto names = arkit_and_head_channels();
  for (std::int64_t n = 0; n < before.motion.num_frames(); ++n)
    for (std::size_t c = 0; c < names.size(); ++c)
      if (!names[c].starts_with("brow") && names[c] != "headPitch") {
        ASSERT_EQ(before.motion.frame(n)[c], after.motion.frame(n)[c]) << names[c] << " at frame " << n;
      }
  EXPECT_NE(before.motion.values, after.motion.values);
}

TEST(Take, DegenerateUtterances) {
  const auto draw = [](const Utterance& u) { return draw_take(u, speaker("S11"), Emotion::sad, 1, 9); };
  const Take nothing = draw({});
  EXPECT_EQ(nothing.motion.num_frames(), 0);
  EXPECT_TRUE(nothing.blinks.empty());
  EXPECT_EQ(default_performance({}).num_frames(), 0);

  Utterance no_phones;
  no_phones.seconds = 3;
  EXPECT_TRUE(in_range(draw(no_phones).motion));
  const Motion rest = default_performance(no_phones);
  EXPECT_EQ(rest.num_frames(), 180);
  for (const float value : rest.values) EXPECT_EQ(value, 0);

  Utterance silence = no_phones;
  silence.phones = {{.start_s = 0, .end_s = 3, .label = "pau", .visemes = {}}};
  for (const float value : default_performance(silence).values) EXPECT_EQ(value, 0);

  Utterance one_phone = no_phones;
  one_phone.phones = {{.start_s = 1, .end_s = 1.1, .label = "aa", .visemes = {Viseme::AA}}};
  const Motion open = default_performance(one_phone);
  EXPECT_TRUE(in_range(draw(one_phone).motion));
  EXPECT_GT(open.frame(63)[arkit_index("jawOpen")], 0.5);
  EXPECT_LT(open.frame(0)[arkit_index("jawOpen")], 0.01);

  Utterance one_frame = one_phone;
  one_frame.seconds = 1.0 / 60;
  EXPECT_EQ(draw(one_frame).motion.num_frames(), 1);

  Utterance empty_phone = one_phone;  // a phone without duration, a closure turned around
  empty_phone.phones.push_back({.start_s = 1.1, .end_s = 1.1, .label = "p", .visemes = {Viseme::PP}});
  empty_phone.phones.back().closure = TimeSpan{1.2, 1.1};
  EXPECT_TRUE(in_range(draw(empty_phone).motion));

  EXPECT_THROW(draw_take(one_phone, speaker("S00"), Emotion::sad, 1.5, 0), std::logic_error);
  one_phone.seconds = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(draw(one_phone), std::logic_error);
  one_phone.seconds = -1;
  EXPECT_THROW(draw(one_phone), std::logic_error);
}

TEST(Take, ContemptIsMirroredForHalfOfTheSpeakers) {
  const Utterance utterance = synthetic_utterance(4, 5);
  const auto smile = [&](std::string_view id, std::string_view channel) {
    const Motion motion = plain_performance(utterance, speaker(id), Emotion::contempt, 1);
    return motion.frame(30)[arkit_index(channel)];
  };
  EXPECT_GT(smile("S00", "mouthDimpleRight"), 3 * smile("S00", "mouthDimpleLeft"));
  EXPECT_GT(smile("S01", "mouthDimpleLeft"), 3 * smile("S01", "mouthDimpleRight"));
}

}  // namespace
}  // namespace mien
