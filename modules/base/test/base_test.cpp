#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <numeric>

#include "mien/base/bytes.h"
#include "mien/base/hash.h"
#include "mien/base/number_text.h"
#include "mien/base/parallel.h"
#include "mien/base/random.h"
#include "mien/base/result.h"

namespace mien {
namespace {

// Known answers published with the generator (Random123, kat_vectors: philox 4x32 10).
TEST(Philox, MatchesPublishedVectors) {
  EXPECT_EQ(philox4x32({0, 0, 0, 0}, {0, 0}),
            (std::array<std::uint32_t, 4>{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  EXPECT_EQ(philox4x32({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}),
            (std::array<std::uint32_t, 4>{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

TEST(NoiseField, IsAddressedByPosition) {
  const NoiseField noise(7, 3);
  std::vector<float> whole(1001), part(13);
  noise.normal(5, 2, whole);
  noise.normal(5 + 490, 2, part);
  for (std::size_t i = 0; i < part.size(); ++i) EXPECT_EQ(part[i], whole[490 + i]);
  const double mean = std::accumulate(whole.begin(), whole.end(), 0.0) / 1001;
  double square = 0;
  for (const float x : whole) square += x * x;
  EXPECT_NEAR(mean, 0.0, 0.1);
  EXPECT_NEAR(square / 1001, 1.0, 0.15);
  noise.normal(5, 3, part);
  EXPECT_NE(part[0], whole[0]);
}

TEST(Rng, HasTheMomentsItPromises) {
  Rng rng(1);
  double sum = 0, square = 0, exponential = 0;
  for (int i = 0; i < 20000; ++i) {
    const double z = rng.normal();
    sum += z, square += z * z, exponential += rng.exponential(2.0);
  }
  EXPECT_NEAR(sum / 20000, 0.0, 0.03);
  EXPECT_NEAR(square / 20000, 1.0, 0.04);
  EXPECT_NEAR(exponential / 20000, 2.0, 0.06);
  for (int i = 0; i < 100; ++i) EXPECT_LT(rng.below(7), 7u);
}

TEST(Half, RoundTripsEveryValue) {
  for (std::uint32_t h = 0; h < 0x10000; ++h) {
    const float value = half_to_float(static_cast<std::uint16_t>(h));
    if (std::isnan(value)) continue;
    EXPECT_EQ(float_to_half(value), h) << value;
  }
  EXPECT_EQ(float_to_half(65520.0f), 0x7c00);
  EXPECT_EQ(float_to_half(1.0f + 0x1p-11f), 0x3c00);  // tie goes to even
}

TEST(NumberText, IgnoresTheLocaleAndRejectsRests) {
  EXPECT_EQ(parse_double("1.5"), 1.5);
  EXPECT_FALSE(parse_double("1,5"));
  EXPECT_FALSE(parse_double("1.5x"));
  EXPECT_FALSE(parse_int(""));
  EXPECT_EQ(fixed(1.0 / 3, 3), "0.333");
  EXPECT_EQ(shortest(0.1f), "0.1");
}

TEST(ParallelFor, RunsEachItemOnceAndRethrows) {
  for (const int threads : {1, 2, 7}) {
    std::vector<std::atomic<int>> count(100);
    parallel_for(threads, 100, [&](std::int64_t i) { ++count[static_cast<std::size_t>(i)]; });
    for (const auto& c : count) EXPECT_EQ(c, 1);
    EXPECT_THROW(parallel_for(threads, 10,
                              [](std::int64_t i) {
                                if (i == 3) throw std::runtime_error("three");
                              }),
                 std::runtime_error);
  }
}

TEST(Result, CarriesValueOrErrorAndChecksMisuse) {
  const Result<int> good = 3;
  const Result<int> bad = Error{Errc::input, "a.wav", "is empty", "Record again"};
  EXPECT_EQ(*good, 3);
  EXPECT_EQ(bad.error().message(), "a.wav: is empty. Record again");
  EXPECT_THROW((void)bad.value(), std::logic_error);
  EXPECT_THROW((void)good.error(), std::logic_error);
}

TEST(Hash, DependsOnTextSeedAndOrder) {
  EXPECT_NE(hash64("a"), hash64("b"));
  EXPECT_NE(hash64("a", 1), hash64("a", 2));
  EXPECT_NE(hash_combine(1, 2), hash_combine(2, 1));
}

TEST(NoiseField, IsBoxMullerOfPhiloxBlocks) {
  constexpr std::uint64_t kSeed = 0x123456789abcdefULL;
  constexpr std::uint32_t kStream = 5, kStep = 3;
  std::vector<float> got(4000);
  NoiseField(kSeed, kStream).normal(0, kStep, got);
  for (std::uint32_t block = 0; block < got.size() / 4; ++block) {
    const auto w = philox4x32({block, 0, kStep, kStream},
                              {static_cast<std::uint32_t>(kSeed), static_cast<std::uint32_t>(kSeed >> 32)});
    for (std::uint32_t pair = 0; pair < 2; ++pair) {
      const double radius = std::sqrt(-2 * std::log((static_cast<double>(w[2 * pair]) + 1) * 0x1p-32));
      const double angle = 2 * std::acos(-1.0) * static_cast<double>(w[2 * pair + 1]) * 0x1p-32;
      ASSERT_NEAR(got[4 * block + 2 * pair], radius * std::cos(angle), 1e-6) << block;
      ASSERT_NEAR(got[4 * block + 2 * pair + 1], radius * std::sin(angle), 1e-6) << block;
    }
  }
}

TEST(NoiseField, GivesTheSameValuesFromAnyPlace) {
  const NoiseField field(7, 1);
  std::vector<float> whole(300), part(37);
  field.normal(0, 2, whole);
  for (std::size_t first = 0; first < 200; ++first) {
    field.normal(first, 2, part);
    for (std::size_t i = 0; i < part.size(); ++i) ASSERT_EQ(part[i], whole[first + i]) << first;
  }
}

}  // namespace
}  // namespace mien
