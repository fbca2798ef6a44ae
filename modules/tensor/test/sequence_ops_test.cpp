#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "mien/base/random.h"
#include "mien/tensor/ops.h"

// Operations along time, against their definitions in double.
namespace mien {
namespace {

Tensor noise(Shape shape, std::uint32_t stream) {
  Tensor x = Tensor::uninitialized(std::move(shape));
  NoiseField(5, stream).normal(0, 0, x.values());
  return x;
}

bool same_bits(const Tensor& a, const Tensor& b) {
  return a.shape() == b.shape() && std::equal(a.values().begin(), a.values().end(), b.values().begin());
}

TEST(StridedConvolution, EqualsTheDefinition) {
  constexpr std::int64_t kIn = 3, kOut = 5;
  for (const auto& [rows, kernel, stride] : {std::array<std::int64_t, 3>{20, 3, 2},
                                             {20, 2, 2},
                                             {21, 10, 5},
                                             {9, 1, 4},
                                             {10, 10, 5},
                                             {9, 10, 5},
                                             {0, 3, 2}}) {
    const Tensor x = noise({rows, kIn}, 1), w = noise({kOut, kIn, kernel}, 2), bias = noise({kOut}, 3);
    const Tensor y = conv_rows(x, PackedMatrix(tap_major(w)), bias, kernel, 1, stride);
    ASSERT_EQ(y.num_rows(), rows < kernel ? 0 : (rows - kernel) / stride + 1);
    for (std::int64_t n = 0; n < y.num_rows(); ++n) {
      for (std::int64_t o = 0; o < kOut; ++o) {
        double want = bias.data()[o];
        for (std::int64_t k = 0; k < kernel; ++k)
          for (std::int64_t i = 0; i < kIn; ++i)
            want += static_cast<double>(x.data()[(n * stride + k) * kIn + i]) *
                    w.data()[(o * kIn + i) * kernel + k];
        EXPECT_NEAR(y.row(n)[static_cast<std::size_t>(o)], want, 1e-5);
      }
    }
  }
  EXPECT_THROW((void)conv_rows(noise({4, 3}, 1), PackedMatrix(noise({5, 6}, 2)), {}, 2, 2, 2),
               std::logic_error);
}

TEST(GroupedConvolution, EqualsTheDefinition) {
  constexpr std::int64_t kRows = 7, kGroups = 2, kIn = 3, kOut = 2, kKernel = 4, kBefore = 2, kAfter = 1;
  const Tensor x = noise({kRows, kGroups * kIn}, 1), w = noise({kGroups * kOut, kIn, kKernel}, 2);
  const Tensor bias = noise({kGroups * kOut}, 3);
  const Tensor y = grouped_conv_rows(x, pack_groups(w, kGroups), bias, kBefore, kAfter);
  ASSERT_EQ(y.shape(), (Shape{kRows, kGroups * kOut}));
  for (std::int64_t n = 0; n < kRows; ++n) {
    for (std::int64_t o = 0; o < kGroups * kOut; ++o) {
      double want = bias.data()[o];
      for (std::int64_t k = 0; k < kKernel; ++k) {
        const std::int64_t t = n + k - kBefore;
        if (t < 0 || t >= kRows) continue;
        for (std::int64_t i = 0; i < kIn; ++i)
          want += static_cast<double>(x.row(t)[static_cast<std::size_t>(o / kOut * kIn + i)]) *
                  w.data()[(o * kIn + i) * kKernel + k];
      }
      EXPECT_NEAR(y.row(n)[static_cast<std::size_t>(o)], want, 1e-5) << n << ' ' << o;
    }
  }
  EXPECT_TRUE(same_bits(y, grouped_conv_rows(x, pack_groups(w, kGroups), bias, kBefore, kAfter, 3)));
  EXPECT_EQ(grouped_conv_rows(rows(x, 0, 0), pack_groups(w, kGroups), bias, 1, 1).num_rows(), 0);
  EXPECT_THROW((void)pack_groups(w, 3), std::logic_error);
  EXPECT_THROW((void)grouped_conv_rows(noise({4, 5}, 1), pack_groups(w, kGroups), bias, 0, 0),
               std::logic_error);
}

TEST(WeightNorm, GivesEveryTapItsLength) {
  const Tensor v = noise({4, 3, 5}, 1), g = noise({1, 1, 5}, 2);
  const Tensor w = weight_norm_taps(v, g);
  for (std::int64_t k = 0; k < 5; ++k) {
    double squares = 0;
    for (std::int64_t i = 0; i < 12; ++i)
      squares += static_cast<double>(w.data()[i * 5 + k]) * w.data()[i * 5 + k];
    EXPECT_NEAR(std::sqrt(squares), std::abs(g.data()[k]), 1e-6);
    EXPECT_EQ(std::signbit(w.data()[k]), std::signbit(v.data()[k]) != std::signbit(g.data()[k]));
  }
  EXPECT_THROW((void)weight_norm_taps(v, noise({4}, 2)), std::logic_error);
}

TEST(GroupNorm, HasMeanBetaAndDeviationGammaOverChannelsAndRows) {
  const Tensor x = noise({20, 6}, 4), gamma = noise({6}, 5), beta = noise({6}, 6);
  const Tensor y = group_norm(x, gamma, beta, 2, 1e-3);
  for (std::size_t g = 0; g < 2; ++g) {
    double mean = 0, variance = 0;
    for (std::int64_t n = 0; n < 20; ++n)
      for (std::size_t i = 3 * g; i < 3 * g + 3; ++i) mean += x.row(n)[i] / 60.0;
    for (std::int64_t n = 0; n < 20; ++n)
      for (std::size_t i = 3 * g; i < 3 * g + 3; ++i) variance += std::pow(x.row(n)[i] - mean, 2) / 60.0;
    for (std::int64_t n = 0; n < 20; ++n)
      for (std::size_t i = 3 * g; i < 3 * g + 3; ++i)
        EXPECT_NEAR(y.row(n)[i],
                    (x.row(n)[i] - mean) / std::sqrt(variance + 1e-3) * gamma.values()[i] + beta.values()[i],
                    1e-5);
  }
  EXPECT_THROW((void)group_norm(x, gamma, beta, 4), std::logic_error);
}

TEST(GroupNorm, OfSingleChannelsNormsEachOverTime) {
  const Tensor gamma({2}, std::vector<float>{2, -1}), beta({2}, std::vector<float>{0.5f, 3});
  const Tensor y = group_norm(noise({50, 2}, 1), gamma, beta, 2, 0.0);
  for (std::size_t c = 0; c < 2; ++c) {
    double sum = 0, squares = 0;
    for (std::int64_t n = 0; n < 50; ++n) sum += y.row(n)[c];
    for (std::int64_t n = 0; n < 50; ++n) squares += std::pow(y.row(n)[c] - sum / 50, 2);
    EXPECT_NEAR(sum / 50, beta.values()[c], 1e-6);
    EXPECT_NEAR(std::sqrt(squares / 50), std::abs(gamma.values()[c]), 1e-6);
  }
  // One row is its own mean, and so is a constant: only beta is left.
  EXPECT_THAT(group_norm(noise({1, 2}, 1), gamma, beta, 2).values(), testing::ElementsAre(0.5f, 3.0f));
  EXPECT_EQ(group_norm(Tensor({0, 2}), gamma, beta, 2).num_rows(), 0);
}

TEST(AttentionWithin, EqualsAttentionOnTheKeysOfTheRange) {
  const Tensor q = noise({9, 8}, 1), k = noise({5, 8}, 2), v = noise({5, 8}, 3);
  std::vector<KeyRange> ranges;
  for (std::int64_t n = 0; n < 9; ++n) ranges.push_back({n / 3, n / 3 + 1 + n % 3});
  Tensor out = Tensor::uninitialized({9, 8}), alone = Tensor::uninitialized({1, 8});
  attention_within(q.view(), k.view(), v.view(), 2, ranges, out.data());
  for (std::int64_t n = 0; n < 9; ++n) {
    const auto [first, end] = ranges[static_cast<std::size_t>(n)];
    const Tensor query = rows(q, n, 1), keys = rows(k, first, end - first),
                 values = rows(v, first, end - first);
    attention({query.view(), keys.view(), values.view(), 2}, alone.data());
    for (std::size_t i = 0; i < 8; ++i) EXPECT_NEAR(out.row(n)[i], alone.row(0)[i], 1e-6) << n;
  }
  ranges[4] = {3, 3};
  EXPECT_THROW(attention_within(q.view(), k.view(), v.view(), 2, ranges, out.data()), std::logic_error);
  ranges[4] = {3, 6};
  EXPECT_THROW(attention_within(q.view(), k.view(), v.view(), 2, ranges, out.data()), std::logic_error);
}

class Attention : public testing::TestWithParam<std::pair<std::int64_t, std::int64_t>> {};

TEST_P(Attention, EqualsTheDefinition) {
  const auto [queries, valid] = GetParam();
  constexpr std::int64_t kKeys = 130, kHeads = 3, kWidth = 4;
  const Tensor q = noise({queries, kHeads * kWidth}, 1), k = noise({kKeys, kHeads * kWidth}, 2);
  const Tensor v = noise({kKeys, kHeads * kWidth}, 3);
  const AttentionInputs in{q.view(), k.view(), v.view(), kHeads, valid};
  Tensor y(q.shape()), again(q.shape());
  attention(in, y.data());
  attention(in, again.data(), 3);
  EXPECT_TRUE(same_bits(y, again));
  // The same with both products in bfloat16: nothing but rounding, and no thread shows.
  AttentionInputs narrow = in;
  narrow.backend = Backend::onednn_bf16;
  attention(narrow, again.data());
  for (std::int64_t i = 0; i < y.count(); ++i) EXPECT_NEAR(again.data()[i], y.data()[i], 0.03) << i;
  Tensor third(q.shape());
  attention(narrow, third.data(), 3);
  EXPECT_TRUE(same_bits(again, third));
  const std::int64_t seen = valid < 0 ? kKeys : valid;
  for (std::int64_t n = 0; n < queries; ++n) {
    for (std::int64_t h = 0; h < kHeads; ++h) {
      std::vector<double> weights;
      double sum = 0;
      for (std::int64_t t = 0; t < seen; ++t) {
        double score = 0;
        for (std::int64_t i = h * kWidth; i < (h + 1) * kWidth; ++i)
          score += static_cast<double>(q.data()[n * q.width() + i]) * k.data()[t * k.width() + i];
        weights.push_back(std::exp(score));
        sum += weights.back();
      }
      for (std::int64_t i = h * kWidth; i < (h + 1) * kWidth; ++i) {
        double want = 0;
        for (std::int64_t t = 0; t < seen; ++t)
          want += weights[static_cast<std::size_t>(t)] / sum * v.data()[t * v.width() + i];
        EXPECT_NEAR(y.data()[n * y.width() + i], want, 2e-6) << n << ' ' << i;
      }
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Sizes, Attention,
                         testing::Values(std::pair{1, -1}, std::pair{96, -1}, std::pair{97, -1},
                                         std::pair{200, 129}, std::pair{5, 1}, std::pair{0, -1}));

TEST(AttentionContract, RefusesSizesThatDoNotFit) {
  const Tensor x = noise({4, 6}, 1), y = noise({4, 8}, 2), shorter = noise({3, 6}, 3);
  float out[24];
  EXPECT_THROW(attention({x.view(), x.view(), x.view(), 4}, out), std::logic_error);
  EXPECT_THROW(attention({x.view(), y.view(), x.view(), 2}, out), std::logic_error);
  EXPECT_THROW(attention({x.view(), x.view(), shorter.view(), 2}, out), std::logic_error);
  EXPECT_THROW(attention({x.view(), x.view(), x.view(), 2, 0}, out), std::logic_error);
}

}  // namespace
}  // namespace mien
