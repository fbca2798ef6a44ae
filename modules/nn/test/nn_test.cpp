#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "mien/base/random.h"
#include "mien/nn/causal.h"
#include "mien/nn/recurrent.h"
#include "mien/nn/runtime_operations.h"
#include "mien/nn/transformer.h"

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

TEST(RnnLayer, FollowsItsEquation) {
  RnnLayer<Tensor> rnn{1, 1};
  rnn.w_ih = PackedMatrix(std::vector<float>{0.7f}, 1, 1);
  rnn.w_hh = PackedMatrix(std::vector<float>{-0.4f}, 1, 1);
  rnn.b_ih = Tensor({1}, std::vector<float>{0.1f});
  rnn.b_hh = Tensor({1}, std::vector<float>{0.2f});
  Tensor state({1, 1});
  const Tensor x({3, 1}, std::vector<float>{1, -2, 0.5f});
  const Tensor y = rnn(x, state);
  double h = 0;
  for (std::int64_t n = 0; n < 3; ++n) {
    h = std::tanh(0.7 * x.data()[n] + 0.1 - 0.4 * h + 0.2);
    EXPECT_NEAR(y.data()[n], h, 1e-6);
  }
  EXPECT_EQ(state.data()[0], y.data()[2]);
}

TEST(LstmLayer, FollowsItsEquationsAndKeepsBothStates) {
  LstmLayer<Tensor> lstm{1, 1};
  lstm.w_ih = PackedMatrix(std::vector<float>{0.5f, -0.3f, 0.8f, 0.6f}, 4, 1);
  lstm.w_hh = PackedMatrix(std::vector<float>{0.2f, 0.4f, -0.6f, 0.3f}, 4, 1);
  lstm.b_ih = Tensor({4}, std::vector<float>{0.1f, 0.2f, 0.3f, -0.2f});
  lstm.b_hh = Tensor({4}, std::vector<float>{-0.1f, 0.05f, 0.15f, 0.4f});
  Tensor state({1, LstmLayer<Tensor>::state_width(1)});
  const Tensor x({3, 1}, std::vector<float>{1, -2, 0.5f});
  const Tensor y = lstm(x, state);
  double h = 0, c = 0;
  const auto sigmoid = [](double v) { return 1 / (1 + std::exp(-v)); };
  for (std::int64_t n = 0; n < 3; ++n) {
    const double in = x.data()[n];
    const double input = sigmoid(0.5 * in + 0.1 + 0.2 * h - 0.1),
                 forget = sigmoid(-0.3 * in + 0.2 + 0.4 * h + 0.05);
    const double cell = std::tanh(0.8 * in + 0.3 - 0.6 * h + 0.15),
                 output = sigmoid(0.6 * in - 0.2 + 0.3 * h + 0.4);
    c = forget * c + input * cell;
    h = output * std::tanh(c);
    EXPECT_NEAR(y.data()[n], h, 1e-6);
  }
  EXPECT_NEAR(state.data()[0], h, 1e-6);
  EXPECT_NEAR(state.data()[1], c, 1e-6);
}

template <class Stack>
void expect_same_bits_in_pieces() {
  Stack stack(5, 4, 2);
  Fill fill;
  stack.visit(fill);
  const Tensor x = noise_rows(9, 5), whole = stack(x);
  std::vector<Tensor> states, parts;
  std::int64_t at = 0;
  for (const std::int64_t count : {1, 0, 6, 2}) {
    parts.push_back(stack(Ops::rows(x, at, count), states));
    at += count;
  }
  const Tensor pieces = Ops::concat_rows(parts);
  for (std::int64_t i = 0; i < whole.count(); ++i) ASSERT_EQ(pieces.data()[i], whole.data()[i]);
}

TEST(RecurrentStack, GivesTheSameBitsInPieces) {
  expect_same_bits_in_pieces<Gru<Tensor>>();
  expect_same_bits_in_pieces<Rnn<Tensor>>();
  expect_same_bits_in_pieces<Lstm<Tensor>>();
}

TEST(Sinusoids, AreSineAndCosineByPairs) {
  const std::vector<float> row = sinusoid_row(3, 12);
  EXPECT_FLOAT_EQ(row[0], std::sin(3.0f));
  EXPECT_FLOAT_EQ(row[1], std::cos(3.0f));
  EXPECT_NEAR(row[5], std::cos(3 * std::pow(10000.0, -4.0 / 12)), 1e-6);
}

TEST(TransformerDecoder, LooksBackwardsAndGoesOnFromWhereItStood) {
  TransformerDecoder<Tensor> decoder(6, 3, 8, 2, 2);
  Fill fill;
  decoder.visit(fill);
  const Tensor memory = noise_rows(5, 6);
  Tensor rows = noise_rows(7, 3);
  auto at_once = decoder.begin(memory);
  const Tensor whole = decoder.next(rows, at_once);
  EXPECT_EQ(whole.shape(), (Shape{7, 8}));
  auto state = decoder.begin(memory);
  for (std::int64_t n = 0; n < 7; ++n) {
    const Tensor one = decoder.next(Ops::rows(rows, n, 1), state);
    for (std::size_t i = 0; i < 8; ++i) EXPECT_NEAR(one.row(0)[i], whole.row(n)[i], 1e-6) << n;
  }
  EXPECT_EQ(state.num_rows, 7);
  rows.row(4)[0] += 1;  // changes rows from 4 on
  auto changed_state = decoder.begin(memory);
  const Tensor changed = decoder.next(rows, changed_state);
  for (std::int64_t n = 0; n < 7; ++n) EXPECT_EQ(changed.row(n)[1] == whole.row(n)[1], n < 4) << n;
  auto empty = decoder.begin(memory);
  EXPECT_EQ(decoder.next(Tensor({0, 3}), empty).shape(), (Shape{0, 8}));
}

TEST(RuntimeOperations, OneRowAppliesToAllAndJoinsMustFit) {
  const Tensor x({2, 2}, std::vector<float>{1, 2, 3, 4}), one({1, 2}, std::vector<float>{10, 20});
  const Tensor sum = Ops::add(x, one), product = Ops::mul(x, one);
  EXPECT_EQ(sum.data()[3], 24);
  EXPECT_EQ(product.data()[2], 30);
  EXPECT_EQ(Ops::concat_rows({x, Tensor({0, 2}), one}).num_rows(), 3);
  EXPECT_THROW(Ops::concat_rows({x, Tensor({1, 3})}), std::logic_error);
}

}  // namespace
}  // namespace mien
