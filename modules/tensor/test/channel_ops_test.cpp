// Operations by channel: norms, transposed convolution, runs along time, distances to a codebook.
#include "mien/tensor/channel_ops.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "mien/base/random.h"
#include "mien/tensor/ops.h"

namespace mien {
namespace {

Tensor noise(Shape shape, std::uint32_t stream) {
  Tensor x(std::move(shape));
  NoiseField(5, stream).normal(0, 0, x.values());
  return x;
}

std::vector<float> values(const Tensor& x) { return {x.values().begin(), x.values().end()}; }

TEST(BatchNorm, UsesTheGivenStatistics) {
  const Tensor x({2, 2}, std::vector<float>{1, 10, 3, 30});
  const Tensor y =
      batch_norm(x, Tensor({2}, std::vector<float>{2, 1}), Tensor({2}, std::vector<float>{0.5f, -1}),
                 Tensor({2}, std::vector<float>{1, 10}), Tensor({2}, std::vector<float>{3, 99}), 1);
  EXPECT_EQ(values(y), (std::vector<float>{0.5f, -1, 2.5f, 1}));
  EXPECT_THROW(batch_norm(x, Tensor({3}), Tensor({2}), Tensor({2}), Tensor({2})), std::logic_error);
  EXPECT_EQ(batch_norm(Tensor({0, 2}), Tensor({2}), Tensor({2}), Tensor({2}), Tensor({2})).num_rows(), 0);
}

TEST(LeakyRelu, KeepsAShareBelowZeroAndNan) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const Tensor y = leaky_relu(Tensor({1, 4}, std::vector<float>{2, -2, 0, nan}), 0.25f);
  EXPECT_EQ(y.data()[0], 2);
  EXPECT_EQ(y.data()[1], -0.5f);
  EXPECT_EQ(y.data()[2], 0);
  EXPECT_TRUE(std::isnan(y.data()[3]));
}

TEST(TransposedConvolution, SpreadsEveryRowOverItsTaps) {
  const Tensor x = noise({5, 3}, 1), weight = noise({3, 2, 4}, 2), bias = noise({2}, 3);
  const Tensor y = transposed_conv_rows(x, weight, bias);
  ASSERT_EQ(y.shape(), (Shape{8, 2}));
  for (std::int64_t n = 0; n < 8; ++n)
    for (std::int64_t o = 0; o < 2; ++o) {
      double want = bias.data()[o];
      for (std::int64_t j = 0; j < 4; ++j)
        for (std::int64_t i = 0; i < 3 && n >= j && n - j < 5; ++i)
          want += static_cast<double>(x.row(n - j)[static_cast<std::size_t>(i)]) *
                  weight.data()[(i * 2 + o) * 4 + j];
      EXPECT_NEAR(y.row(n)[static_cast<std::size_t>(o)], want, 1e-5) << n << " " << o;
    }
  EXPECT_EQ(transposed_conv_rows(Tensor({0, 3}), weight, bias).shape(), (Shape{0, 2}));
  EXPECT_THROW(transposed_conv_rows(x, noise({4, 2, 4}, 4), bias), std::logic_error);
}

// A latent is cut into codes along time, channel by channel, and put together again.
TEST(ChannelRuns, GoChannelByChannelAndBack) {
  const Tensor x({3, 2}, std::vector<float>{1, 10, 2, 20, 3, 30});
  const Tensor flat = channel_runs(x, 6);
  EXPECT_EQ(flat.shape(), (Shape{1, 6}));
  EXPECT_EQ(values(flat), (std::vector<float>{1, 2, 3, 10, 20, 30}));
  const Tensor runs = channel_runs(x, 2);
  EXPECT_EQ(runs.shape(), (Shape{3, 2}));
  EXPECT_EQ(values(runs), values(flat));
  for (const Tensor& cut : {flat, runs}) {
    const Tensor back = from_channel_runs(cut, 3);
    EXPECT_EQ(back.shape(), x.shape());
    EXPECT_EQ(values(back), values(x));
  }
  EXPECT_THROW(channel_runs(x, 4), std::logic_error);
  EXPECT_THROW(channel_runs(x, 0), std::logic_error);
  EXPECT_THROW(from_channel_runs(flat, 4), std::logic_error);
  EXPECT_EQ(channel_runs(Tensor({0, 4}), 2).shape(), (Shape{0, 2}));
}

TEST(SquaredDistances, AreThoseOfRows) {
  const Tensor x = noise({3, 5}, 1), table = scale(noise({4, 5}, 2), 2);
  const Tensor distances = squared_distances(x, table);
  ASSERT_EQ(distances.shape(), (Shape{3, 4}));
  for (std::int64_t n = 0; n < 3; ++n)
    for (std::int64_t k = 0; k < 4; ++k) {
      double want = 0;
      for (std::size_t i = 0; i < 5; ++i)
        want += std::pow(static_cast<double>(x.row(n)[i]) - static_cast<double>(table.row(k)[i]), 2);
      EXPECT_NEAR(distances.row(n)[static_cast<std::size_t>(k)], want, 1e-5);
    }
  EXPECT_THROW(squared_distances(x, noise({4, 6}, 2)), std::logic_error);
}

TEST(InstanceNorm, NormsEveryChannelOverTime) {
  const Tensor y = instance_norm(noise({40, 3}, 1), 0.0);
  for (std::size_t c = 0; c < 3; ++c) {
    double sum = 0, squares = 0;
    for (std::int64_t n = 0; n < 40; ++n) sum += y.row(n)[c], squares += std::pow(y.row(n)[c], 2);
    EXPECT_NEAR(sum / 40, 0, 1e-6);
    EXPECT_NEAR(squares / 40, 1, 1e-5);
  }
  EXPECT_EQ(values(instance_norm(noise({1, 3}, 1))), std::vector<float>(3)) << "one frame is its own mean";
}

}  // namespace
}  // namespace mien
