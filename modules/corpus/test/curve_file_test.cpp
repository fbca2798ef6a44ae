#include "mien/corpus/curve_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "mien/base/random.h"
#include "mien/corpus/take.h"
#include "synthetic_utterance.h"

namespace mien {
namespace {

CurveSet small_set() {
  CurveSet set{
      .fps = 60, .num_takes = 2, .num_frames = 3, .num_channels = 52, .first_is_mean = true, .values = {}};
  for (int i = 0; i < 2 * 3 * 52; ++i) set.values.push_back(static_cast<float>(i) / 512);
  return set;
}

TEST(CurveFile, SinglePrecisionRoundTripIsExact) {
  const Utterance utterance = synthetic_utterance(3, 1);
  std::vector<Motion> takes;
  for (std::uint64_t k = 0; k < 3; ++k)
    takes.push_back(draw_take(utterance, fixed_speakers()[2], Emotion::fear, 1, k).motion);
  const CurveSet set = curve_set(takes, false);
  const auto back = decode_curves(encode_curves(set, CurvePrecision::single), "x");
  ASSERT_TRUE(back.has_value());
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(back->take(k).values, takes[static_cast<std::size_t>(k)].values);
    EXPECT_EQ(back->take(k).channels, takes[0].channels);
  }
  EXPECT_FALSE(back->first_is_mean);
  EXPECT_THROW((void)back->take(3), std::logic_error);
}

TEST(CurveFile, HalfPrecisionIsCloseAndHalfTheSize) {
  const CurveSet set = small_set();
  const Bytes bytes = encode_curves(set, CurvePrecision::half);
  EXPECT_EQ(bytes.size(), 24 + set.values.size() * 2);
  EXPECT_EQ(encode_curves(set, CurvePrecision::single).size(), 24 + set.values.size() * 4);
  const auto back = decode_curves(bytes, "x");
  ASSERT_TRUE(back.has_value());
  EXPECT_TRUE(back->first_is_mean);
  EXPECT_EQ(back->fps, 60);
  for (std::size_t i = 0; i < set.values.size(); ++i) EXPECT_NEAR(back->values[i], set.values[i], 3e-4);
}

TEST(CurveFile, HeaderIsAsSpecified) {
  const Bytes bytes = encode_curves(small_set(), CurvePrecision::half);
  EXPECT_EQ(as_text(std::span(bytes).first(4)), "PCV1");
  EXPECT_EQ(*read_le<std::uint32_t>(bytes, 4), 60000u);
  EXPECT_EQ(*read_le<std::uint32_t>(bytes, 8), 3u);
  EXPECT_EQ(*read_le<std::uint32_t>(bytes, 12), 52u);
  EXPECT_EQ(*read_le<std::uint32_t>(bytes, 16), 2u);
  EXPECT_EQ(*read_le<std::uint32_t>(bytes, 20), 3u);
}

TEST(CurveFile, EmptySets) {
  const CurveSet none{.num_channels = 55};
  const auto back = decode_curves(encode_curves(none, CurvePrecision::single), "x");
  ASSERT_TRUE(back.has_value());
  EXPECT_EQ(back->num_takes, 0);
  EXPECT_EQ(curve_set({}, false).num_takes, 0);
  const Motion other{MotionSpace::arkit, {"jawOpen"}, 60, {0.5f}};
  EXPECT_THROW(curve_set({&other, 1}, false), std::logic_error);
}

TEST(CurveFile, EveryTruncationIsAnError) {
  for (const auto precision : {CurvePrecision::half, CurvePrecision::single}) {
    const Bytes whole = encode_curves(small_set(), precision);
    for (std::size_t n = 0; n < whole.size(); ++n) {
      const Bytes cut(whole.begin(),
                      whole.begin() + static_cast<std::ptrdiff_t>(n));  // exact size, for the sanitizer
      ASSERT_FALSE(decode_curves(cut, "x").has_value()) << n;
    }
    Bytes longer = whole;
    longer.push_back(std::byte{0});
    EXPECT_FALSE(decode_curves(longer, "x").has_value());
  }
}

TEST(CurveFile, FlippedBytesNeverCrashAndHugeSizesAreRefused) {
  const Bytes whole = encode_curves(small_set(), CurvePrecision::single);
  Rng rng(5);
  for (int i = 0; i < 2000; ++i) {
    Bytes broken = whole;
    broken[i % 2 ? rng.below(24) : rng.below(broken.size())] ^= static_cast<std::byte>(1 + rng.below(255));
    const auto read = decode_curves(broken, "x");
    if (read) {
      EXPECT_EQ(std::ssize(read->values), read->num_takes * read->num_frames * read->num_channels);
    }
  }
  Bytes huge(whole.begin(), whole.begin() + 4);
  append_le(huge, 60000u);
  for (int i = 0; i < 3; ++i) append_le(huge, i == 1 ? 52u : 0xffffffffu);
  append_le(huge, 0u);
  const auto read = decode_curves(huge, "x");
  ASSERT_FALSE(read.has_value());
  EXPECT_EQ(read.error().code, Errc::input);
}

TEST(CurveFile, ValuesMustBeFinite) {
  CurveSet set = small_set();
  set.values[100] = std::numeric_limits<float>::quiet_NaN();
  for (const auto precision : {CurvePrecision::half, CurvePrecision::single}) {
    const auto read = decode_curves(encode_curves(set, precision), "a.pcv");
    ASSERT_FALSE(read.has_value());
    EXPECT_NE(read.error().message().find("value 100"), std::string::npos) << read.error().message();
  }
}

TEST(CurveFile, MissingFileIsAnError) {
  EXPECT_FALSE(read_curves("/nowhere/x.pcv").has_value());
  EXPECT_FALSE(write_curves("/nowhere/x.pcv", small_set(), CurvePrecision::half).has_value());
}

}  // namespace
}  // namespace mien
