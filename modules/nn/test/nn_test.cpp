#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "mien/base/random.h"
#include "mien/nn/causal.h"
#include "mien/nn/runtime_operations.h"

namespace mien {
namespace {

using Ops = Operations<Tensor>;

// Fills parameters with noise.
class Fill : public ParameterVisitor<Fill> {
 public:
  void matrix(std::string_view name, PackedMatrix& slot, std::int64_t out, std::int64_t in, Init) {
    names.push_back(full_name(name));
    slot = PackedMatrix(noise(out * in, 0.3f), out, in);
  }
  void tensor(std::string_view name, Tensor& slot, const Shape& shape, Init) {
    names.push_back(full_name(name));
    slot = Tensor(shape, noise(shape[0], 0.3f));
  }
  std::vector<std::string> names;

 private:
  std::vector<float> noise(std::int64_t count, float scale) {
    std::vector<float> v(static_cast<std::size_t>(count));
    NoiseField(++stream_, 0).normal(0, 0, v);
    for (float& x : v) x *= scale;
    return v;
  }
  std::uint64_t stream_ = 0;
};

Tensor noise_rows(std::int64_t rows, std::int64_t width) {
  Tensor x({rows, width});
  NoiseField(99, 0).normal(0, 0, x.values());
  return x;
}

TEST(ParameterVisitor, JoinsNamesOfNestedModules) {
  CausalBlock<Tensor> block{8, 2};
  Fill fill;
  fill.scope("blocks.0", block);
  EXPECT_EQ(fill.names,
            (std::vector<std::string>{"blocks.0.norm.weight", "blocks.0.norm.bias", "blocks.0.conv.weight",
                                      "blocks.0.conv.bias", "blocks.0.mix.weight", "blocks.0.mix.bias"}));
}

TEST(CausalConv, SeesThePastOnlyAndZerosBeforeTheStart) {
  CausalConv<Tensor> conv{1, 1, 2, 3};
  conv.taps.weight = PackedMatrix(std::vector<float>{10, 1}, 1, 2);  // oldest tap first
  conv.taps.bias = Tensor({1}, std::vector<float>{0.5f});
  const Tensor x({5, 1}, std::vector<float>{1, 2, 3, 4, 5});
  const Tensor y = conv(x, nullptr);
  EXPECT_EQ(std::vector<float>(y.values().begin(), y.values().end()),
            (std::vector<float>{1.5f, 2.5f, 3.5f, 14.5f, 25.5f}));
}

TEST(CausalBlock, GivesTheSameBitsForAnyCut) {
  CausalBlock<Tensor> first{16, 1}, second{16, 4};
  Fill fill;
  fill.scope("first", first);
  fill.scope("second", second);
  const Tensor x = noise_rows(37, 16);
  const auto run = [&](const std::vector<std::int64_t>& cuts) {
    CausalState<Tensor> state;
    std::vector<Tensor> out;
    std::int64_t at = 0;
    for (const std::int64_t count : cuts) {
      state.rewind();
      out.push_back(second(first(Ops::rows(x, at, count), &state), &state));
      at += count;
    }
    return Ops::concat_rows(out);
  };
  const Tensor whole = run({37});
  for (const auto& cuts :
       std::vector<std::vector<std::int64_t>>{{1, 36}, {5, 7, 25}, std::vector<std::int64_t>(37, 1)}) {
    const Tensor pieces = run(cuts);
    for (std::int64_t i = 0; i < whole.count(); ++i) ASSERT_EQ(pieces.data()[i], whole.data()[i]);
  }
}

TEST(GruLayer, FollowsItsEquationsAndKeepsItsState) {
  GruLayer<Tensor> gru{1, 1};
  gru.w_ih = PackedMatrix(std::vector<float>{0.5f, -0.3f, 0.8f}, 3, 1);
  gru.w_hh = PackedMatrix(std::vector<float>{0.2f, 0.4f, -0.6f}, 3, 1);
  gru.b_ih = Tensor({3}, std::vector<float>{0.1f, 0.2f, 0.3f});
  gru.b_hh = Tensor({3}, std::vector<float>{-0.1f, 0.05f, 0.15f});
  Tensor state({1, 1});
  const Tensor x({3, 1}, std::vector<float>{1, -2, 0.5f});
  const Tensor y = gru(x, state);
  double h = 0;
  const auto sigmoid = [](double v) { return 1 / (1 + std::exp(-v)); };
  for (std::int64_t n = 0; n < 3; ++n) {
    const double in = x.data()[n];
    const double r = sigmoid(0.5 * in + 0.1 + 0.2 * h - 0.1), z = sigmoid(-0.3 * in + 0.2 + 0.4 * h + 0.05);
    const double fresh = std::tanh(0.8 * in + 0.3 + r * (-0.6 * h + 0.15));
    h = (1 - z) * fresh + z * h;
    EXPECT_NEAR(y.data()[n], h, 1e-6);
  }
  EXPECT_EQ(state.data()[0], y.data()[2]);
}

TEST(RuntimeOperations, OneRowAppliesToAllAndJoinsMustFit) {
  const Tensor x({2, 2}, std::vector<float>{1, 2, 3, 4}), one({1, 2}, std::vector<float>{10, 20});
  const Tensor sum = Ops::add(x, one), product = Ops::mul(x, one);
  EXPECT_EQ(sum.data()[3], 24);
  EXPECT_EQ(product.data()[2], 30);
  EXPECT_EQ(Ops::concat_rows({x, Tensor({0, 2}), one}).num_rows(), 3);
  EXPECT_THROW(Ops::concat_rows({x, Tensor({1, 3})}), std::logic_error);
}

// A latent is cut into codes along time, channel by channel, and put together again.
TEST(RuntimeOperations, ChannelRunsGoThereAndBack) {
  const Tensor x = noise_rows(6, 4);
  const Tensor runs = Ops::channel_runs(x, 8);
  EXPECT_EQ(runs.shape(), (Shape{3, 8}));
  for (std::int64_t c = 0; c < 4; ++c)
    for (std::int64_t n = 0; n < 6; ++n)
      EXPECT_EQ(runs.data()[6 * c + n], x.row(n)[static_cast<std::size_t>(c)]);
  const Tensor back = Ops::from_channel_runs(runs, 6);
  EXPECT_TRUE(std::ranges::equal(back.values(), x.values()));
  EXPECT_THROW((void)Ops::channel_runs(x, 5), std::logic_error);
  EXPECT_THROW((void)Ops::from_channel_runs(runs, 7), std::logic_error);
}

TEST(RuntimeOperations, SquaredDistancesAreThoseOfRows) {
  const Tensor x = noise_rows(3, 5), table = Ops::scale(noise_rows(4, 5), 2);
  const Tensor distances = Ops::squared_distances(x, table);
  for (std::int64_t n = 0; n < 3; ++n)
    for (std::int64_t k = 0; k < 4; ++k) {
      double want = 0;
      for (std::size_t i = 0; i < 5; ++i)
        want += std::pow(static_cast<double>(x.row(n)[i]) - static_cast<double>(table.row(k)[i]), 2);
      EXPECT_NEAR(distances.row(n)[static_cast<std::size_t>(k)], want, 1e-5);
    }
  EXPECT_THROW((void)Ops::squared_distances(x, noise_rows(4, 6)), std::logic_error);
}

TEST(RuntimeOperations, InstanceNormNormsEveryChannelOverTime) {
  const Tensor y = Ops::instance_norm(noise_rows(40, 3), 0.0);
  for (std::size_t c = 0; c < 3; ++c) {
    double sum = 0, squares = 0;
    for (std::int64_t n = 0; n < 40; ++n) sum += y.row(n)[c], squares += std::pow(y.row(n)[c], 2);
    EXPECT_NEAR(sum / 40, 0, 1e-6);
    EXPECT_NEAR(squares / 40, 1, 1e-5);
  }
  EXPECT_TRUE(std::ranges::all_of(Ops::instance_norm(noise_rows(1, 3), 1e-5).values(), [](float v) {
    return v == 0;
  })) << "one frame is its own mean";
}

}  // namespace
}  // namespace mien
