#include "mien/motion/kept_values.h"

#include <gmock/gmock.h>

#include "mien/core/arkit.h"

namespace mien {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

// Two seconds of four channels; value = 100 n + c.
Motion counting(std::int64_t num_frames = 120) {
  Motion motion{MotionSpace::arkit, {"jawOpen", "mouthSmileLeft", "mouthSmileRight", "headYaw"}, 60, {}};
  for (std::int64_t n = 0; n < num_frames; ++n)
    for (std::int64_t c = 0; c < 4; ++c) motion.values.push_back(static_cast<float>(100 * n + c));
  return motion;
}

TEST(FramesOfRange, AreThoseWhoseInstantsLieInIt) {
  const Motion motion = counting();
  EXPECT_EQ(*frames_of_range("0.5-1", motion), (FrameRange{30, 61}));
  EXPECT_EQ(*frames_of_range("1.20-1.20", motion), (FrameRange{72, 73})) << "one instant is one frame";
  EXPECT_EQ(*frames_of_range("0.501-0.52", motion), (FrameRange{31, 32}));
  EXPECT_EQ(*frames_of_range("0-2", motion), (FrameRange{0, 120}));
  Motion slow = counting(30);
  slow.fps = 29.97;
  EXPECT_EQ(*frames_of_range("0.1-0.2", slow), (FrameRange{3, 6}));
}

TEST(FramesOfRange, RefusesWhatIsNoStretchOfTheMotion) {
  const auto refusal = [](std::string_view text) {
    const auto range = frames_of_range(text, counting());
    EXPECT_FALSE(range) << text;
    if (range) return std::string();
    EXPECT_EQ(range.error().code, Errc::usage);
    EXPECT_THAT(range.error().what, HasSubstr(text));
    return range.error().why;
  };
  for (const char* text :
       {"", "-", "1", "1.0", "a-b", "1-", "-1-2", "1-2-3", "nan-1", "0-inf", "1e999-2", " 1-2"})
    EXPECT_THAT(refusal(text), HasSubstr("not a stretch")) << text;
  EXPECT_THAT(refusal("1.5-1.2"), HasSubstr("ends before"));
  EXPECT_THAT(refusal("1.5-2.1"), HasSubstr("2.000 s"));
  EXPECT_THAT(refusal("3-4"), HasSubstr("2.000 s"));
  EXPECT_THAT(refusal("0.505-0.51"), HasSubstr("no frame"));
  EXPECT_THAT(refusal("2-2"), HasSubstr("no frame")) << "the last frame is at 1.983 s";
}

TEST(MatchingChannels, KnowsStarsAndSpellings) {
  const Motion motion = counting();
  EXPECT_THAT(matching_channels(motion, "mouthSmile*"), ElementsAre(1, 2));
  EXPECT_THAT(matching_channels(motion, "*"), ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(matching_channels(motion, "*Left"), ElementsAre(1));
  EXPECT_THAT(matching_channels(motion, "m*S*e*"), ElementsAre(1, 2));
  EXPECT_THAT(matching_channels(motion, "jaw?pen"), ElementsAre(0));
  EXPECT_THAT(matching_channels(motion, "headYaw"), ElementsAre(3));
  EXPECT_THAT(matching_channels(motion, "MouthSmile_R"), ElementsAre(2));
  EXPECT_THAT(matching_channels(motion, "mouthSmile"), IsEmpty());
  EXPECT_THAT(matching_channels(motion, ""), IsEmpty());
  EXPECT_THAT(matching_channels(motion, "eyeBlinkLeft"), IsEmpty());
  const std::string hostile = std::string(5000, '*') + "x";
  EXPECT_THAT(matching_channels(motion, hostile), IsEmpty());
  EXPECT_THAT(matching_channels(vertex_motion(topology_of(2), 30, std::vector<float>(6)), "*"), IsEmpty());
}

TEST(KeptValues, KeepsNothingAtFirst) {
  const KeptValues kept(counting(3));
  EXPECT_EQ(kept.num_frames(), 3);
  EXPECT_EQ(kept.num_channels(), 4);
  EXPECT_EQ(kept.value(2, 1), 201);
  EXPECT_FALSE(kept.keeps(2, 1));
  EXPECT_TRUE(kept.frees_frame(1));
  EXPECT_EQ(kept.edited(), (FrameRange{0, 3}));
  const KeptValues empty(counting(0));
  EXPECT_EQ(empty.edited(), FrameRange{});
}

TEST(KeptValues, AddsUpWhatIsAskedFor) {
  KeptValues kept(counting(10));
  const std::vector<FrameRange> stretches = {{2, 5}, {4, 7}};
  kept.keep_outside(stretches);
  EXPECT_EQ(kept.edited(), (FrameRange{2, 7}));
  EXPECT_TRUE(kept.keeps_frame(1));
  EXPECT_TRUE(kept.frees_frame(4));
  kept.keep_channel(3);
  EXPECT_TRUE(kept.keeps(4, 3));
  EXPECT_FALSE(kept.keeps(4, 2));
  EXPECT_FALSE(kept.frees_frame(4));
  kept.keep(4, 2, 0.25f);
  EXPECT_EQ(kept.weight(4, 2), 0.25f);
  kept.keep(1, 2, 0.25f);
  EXPECT_EQ(kept.weight(1, 2), 1) << "the stronger wish holds";
  kept.set(5, 0, -7);
  EXPECT_EQ(kept.value(5, 0), -7);
  EXPECT_TRUE(kept.keeps(5, 0));
  for (std::int64_t n = 0; n < 10; ++n)
    for (std::int64_t c = 0; c < 4; ++c) kept.keep(n, c);
  EXPECT_EQ(kept.edited(), FrameRange{});
}

TEST(KeptValues, PastesKnownValuesNoisedToTheLevel) {
  KeptValues kept(4, {1, 2, 3, 4}, {1, 0, 0.5f, 1});
  const NoiseLevel level{0.6, 0.8};
  const std::vector<float> noise = {1, 1, 1, -1};
  std::vector<float> x = {9, 9, 9, 9};
  kept.paste(0, level, noise, x);
  EXPECT_FLOAT_EQ(x[0], 0.6f * 1 + 0.8f);
  EXPECT_EQ(x[1], 9);
  EXPECT_FLOAT_EQ(x[2], 0.5f * (0.6f * 3 + 0.8f) + 0.5f * 9);
  EXPECT_FLOAT_EQ(x[3], 0.6f * 4 - 0.8f);
  std::vector<float> clean = {9, 9, 9, 9};
  kept.paste(0, clean);
  EXPECT_THAT(clean, ElementsAre(1, 9, 6, 4));
}

TEST(KeptValues, BreaksOfItsContractThrow) {
  EXPECT_THROW(KeptValues(2, {1, 2, 3}, {0, 0, 0}), std::logic_error);
  EXPECT_THROW(KeptValues(2, {1, 2}, {0, 2}), std::logic_error);
  EXPECT_THROW(KeptValues(0, {}, {}), std::logic_error);
  KeptValues kept(counting(2));
  EXPECT_THROW(kept.keep(2, 0), std::logic_error);
  EXPECT_THROW(kept.keep(0, 4), std::logic_error);
  std::vector<float> narrow(3);
  EXPECT_THROW(kept.paste(0, narrow), std::logic_error);
}

}  // namespace
}  // namespace mien
