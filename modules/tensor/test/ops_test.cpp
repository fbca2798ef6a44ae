#include "mien/tensor/ops.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <vector>

#include "elementwise_dispatch.h"
#include "mien/base/random.h"

namespace mien {
namespace {

using testing::ElementsAre;
constexpr float kInf = std::numeric_limits<float>::infinity();
const float kNan = std::numeric_limits<float>::quiet_NaN();

Tensor random_tensor(Shape shape, std::uint64_t seed, float size = 1.0f) {
  Tensor t(std::move(shape));
  NoiseField(seed, 0).normal(0, 0, t.values());
  return scale(std::move(t), size);
}

bool same_bits(std::span<const float> a, std::span<const float> b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size_bytes()) == 0);
}

/// Values that cover the range of float: all exponents, both signs, some fractions.
std::vector<float> sweep() {
  std::vector<float> values{0.0f, -0.0f};
  for (int e = -149; e < 128; ++e)
    for (const float f : {1.0f, 1.1f, 1.37f, 1.73f, 1.999999f})
      for (const float s : {1.0f, -1.0f}) values.push_back(s * std::ldexp(f, e));
  for (int i = -200000; i <= 200000; ++i) values.push_back(static_cast<float>(i) * 6e-4f);
  return values;
}

struct Function {
  const char* name;
  Tensor (*ours)(Tensor);
  elementwise::Unary op;
  double (*exact)(double);
  double absolute, relative;  ///< allowed error: absolute + relative * |exact|
};

void PrintTo(const Function& function, std::ostream* out) { *out << function.name; }

const Function kFunctions[] = {
    {"exp", exp, elementwise::Unary::exp, [](double x) { return std::exp(x); }, 1.5e-45, 0x1p-23},
    {"sigmoid", sigmoid, elementwise::Unary::sigmoid, [](double x) { return 1 / (1 + std::exp(-x)); }, 2e-7,
     0},
    {"tanh", tanh, elementwise::Unary::tanh, [](double x) { return std::tanh(x); }, 1.5e-45, 2e-7},
    {"silu", silu, elementwise::Unary::silu, [](double x) { return x / (1 + std::exp(-x)); }, 1e-35, 2.5e-7},
    {"gelu", gelu, elementwise::Unary::gelu,
     [](double x) { return 0.5 * x * std::erfc(-x / std::sqrt(2.0)); }, 1e-7, 1e-7},
    {"mish", mish, elementwise::Unary::mish, [](double x) { return x * std::tanh(std::log1p(std::exp(x))); },
     1e-35, 4e-7},
    {"relu", relu, elementwise::Unary::relu, [](double x) { return x < 0 ? 0 : x; }, 0, 0},
};

class EveryFunction : public testing::TestWithParam<Function> {};
INSTANTIATE_TEST_SUITE_P(, EveryFunction, testing::ValuesIn(kFunctions),
                         [](const auto& param) { return std::string(param.param.name); });

TEST_P(EveryFunction, StaysInsideItsStatedError) {
  const auto values = sweep();
  const Tensor y = GetParam().ours(Tensor({static_cast<std::int64_t>(values.size())}, values));
  double worst = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double exact = GetParam().exact(static_cast<double>(values[i]));
    const auto ours = static_cast<double>(y.data()[i]);
    if (std::abs(exact) > 3.4028235e38) {
      EXPECT_EQ(ours, static_cast<double>(static_cast<float>(exact))) << values[i];
      continue;
    }
    const double allowed = GetParam().absolute + GetParam().relative * std::abs(exact);
    ASSERT_LE(std::abs(ours - exact), allowed) << GetParam().name << "(" << values[i] << ")";
    if (allowed > 0) worst = std::max(worst, std::abs(ours - exact) / allowed);
  }
  RecordProperty("share_of_allowed_error", std::to_string(worst));
}

TEST_P(EveryFunction, GivesTheSameBitsAtEveryPlaceAndOnEveryInstructionSet) {
  const auto values = sweep();
  for (const std::int64_t count : {0, 1, 3, 7, 15, 16, 17, 33, 1000}) {
    for (const std::int64_t first : {0, 1, 5, 3000, 100001}) {
      std::vector<float> reference(static_cast<std::size_t>(count));
      for (std::int64_t i = 0; i < count; ++i)
        reference[static_cast<std::size_t>(i)] =
            GetParam()
                .ours(Tensor({1}, std::span(&values[static_cast<std::size_t>(first + i)], 1)))
                .data()[0];
      for (const auto set : usable_instruction_sets()) {
        std::vector<float> y(static_cast<std::size_t>(count));
        elementwise::kernels_for(set).unary[static_cast<int>(GetParam().op)](values.data() + first, y.data(),
                                                                             count);
        EXPECT_TRUE(same_bits(y, reference))
            << instruction_set_name(set) << ", " << count << " from " << first;
      }
    }
  }
}

TEST_P(EveryFunction, PassesNanAndTakesInfinity) {
  const Tensor y = GetParam().ours(Tensor({3}, std::vector<float>{kNan, kInf, 1.0f}));
  EXPECT_TRUE(std::isnan(y.data()[0]));
  const auto at_infinity = static_cast<float>(GetParam().exact(1e30));
  EXPECT_EQ(y.data()[1], at_infinity > 2 ? kInf : at_infinity);
  EXPECT_FALSE(std::isnan(y.data()[2]));
}

TEST(Arithmetic, CombinesEqualShapesAndRows) {
  const Tensor a({2, 2}, std::vector<float>{1, 2, 3, 4}), row({2}, std::vector<float>{10, 20});
  EXPECT_THAT(add(a, row).values(), ElementsAre(11, 22, 13, 24));
  EXPECT_THAT(sub(a, a).values(), ElementsAre(0, 0, 0, 0));
  EXPECT_THAT(mul(a, row).values(), ElementsAre(10, 40, 30, 80));
  EXPECT_THAT(scale(a, 2).values(), ElementsAre(2, 4, 6, 8));
  EXPECT_EQ(add(Tensor({0, 2}), row).shape(), (Shape{0, 2}));
  EXPECT_THROW((void)add(a, Tensor({3})), std::logic_error);
  EXPECT_THROW((void)add(a, Tensor({4})), std::logic_error);
  EXPECT_TRUE(std::isnan(mul(a, Tensor({2}, std::vector<float>{kNan, 1})).data()[2]));
}

TEST(LayerNorm, MatchesTheDefinition) {
  const Tensor x = random_tensor({3, 5, 37}, 1, 4.0f), gamma = random_tensor({37}, 2),
               beta = random_tensor({37}, 3);
  const Tensor y = layer_norm(x, gamma, beta, 1e-5);
  for (std::int64_t r = 0; r < 15; ++r) {
    double mean = 0, square = 0;
    for (const float v : x.row(r)) mean += static_cast<double>(v) / 37;
    for (const float v : x.row(r))
      square += (static_cast<double>(v) - mean) * (static_cast<double>(v) - mean) / 37;
    for (std::size_t i = 0; i < 37; ++i)
      EXPECT_NEAR(y.row(r)[i],
                  (static_cast<double>(x.row(r)[i]) - mean) / std::sqrt(square + 1e-5) *
                          static_cast<double>(gamma.data()[i]) +
                      static_cast<double>(beta.data()[i]),
                  2e-6);
  }
}

TEST(LayerNorm, ConstantRowsGiveBetaAndNanStaysInItsRow) {
  const Tensor ones({4}, std::vector<float>{1, 1, 1, 1}), beta({4}, std::vector<float>{1, 2, 3, 4});
  EXPECT_THAT(layer_norm(Tensor({1, 4}, std::vector<float>(4, 7.0f)), ones, beta).values(),
              ElementsAre(1, 2, 3, 4));
  const Tensor y = layer_norm(Tensor({2, 4}, std::vector<float>{kNan, 0, 0, 0, 1, 2, 3, 4}), ones, beta);
  EXPECT_TRUE(std::isnan(y.row(0)[3]));
  EXPECT_FALSE(std::isnan(y.row(1)[0]));
  EXPECT_EQ(layer_norm(Tensor({0, 4}), ones, beta).num_rows(), 0);
}

TEST(Softmax, SumsToOneAndSurvivesLargeValues) {
  const Tensor y = softmax_last(Tensor({2, 3}, std::vector<float>{1000, 1000, -kInf, 1, 2, 3}));
  EXPECT_THAT(y.row(0), ElementsAre(0.5f, 0.5f, 0.0f));
  const double sum = std::exp(1.0) + std::exp(2.0) + std::exp(3.0);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_NEAR(y.row(1)[i], std::exp(static_cast<double>(i) + 1) / sum, 1e-7);
  EXPECT_TRUE(std::isnan(softmax_last(Tensor({3}, std::vector<float>{0, kNan, 0})).data()[0]));
  EXPECT_EQ(softmax_last(Tensor({0, 3})).count(), 0);
  EXPECT_EQ(softmax_last(Tensor({3, 0})).count(), 0);
}

TEST(Gru, MatchesPytorchEquations) {
  const std::int64_t in = 5, width = 19;
  const Tensor x = random_tensor({3, in}, 1), h = random_tensor({3, width}, 2),
               w_ih = random_tensor({3 * width, in}, 3), w_hh = random_tensor({3 * width, width}, 4),
               b_ih = random_tensor({3 * width}, 5), b_hh = random_tensor({3 * width}, 6);
  const Tensor next = gru_step(x, h, PackedMatrix(w_ih), PackedMatrix(w_hh), b_ih, b_hh);
  const auto project = [](const Tensor& w, const Tensor& b, std::span<const float> v, std::int64_t row) {
    auto sum = static_cast<double>(b.data()[row]);
    for (std::size_t k = 0; k < v.size(); ++k)
      sum += static_cast<double>(w.row(row)[k]) * static_cast<double>(v[k]);
    return sum;
  };
  const auto sigma = [](double v) { return 1 / (1 + std::exp(-v)); };
  for (std::int64_t m = 0; m < 3; ++m) {
    for (std::int64_t i = 0; i < width; ++i) {
      const auto gi = [&](std::int64_t gate) { return project(w_ih, b_ih, x.row(m), gate * width + i); };
      const auto gh = [&](std::int64_t gate) { return project(w_hh, b_hh, h.row(m), gate * width + i); };
      const double r = sigma(gi(0) + gh(0)), z = sigma(gi(1) + gh(1)), n = std::tanh(gi(2) + r * gh(2));
      const double expected = (1 - z) * n + z * static_cast<double>(h.row(m)[static_cast<std::size_t>(i)]);
      EXPECT_NEAR(next.row(m)[static_cast<std::size_t>(i)], expected, 3e-6);
    }
  }
  EXPECT_EQ(gru_step(Tensor({0, in}), Tensor({0, width}), PackedMatrix(w_ih), PackedMatrix(w_hh), b_ih, b_hh)
                .shape(),
            (Shape{0, width}));
  EXPECT_THROW((void)gru_step(x, Tensor({2, width}), PackedMatrix(w_ih), PackedMatrix(w_hh), b_ih, b_hh),
               std::logic_error);
}

TEST(Rows, EveryInstructionSetGivesTheSameBits) {
  for (const std::int64_t width : {1, 5, 16, 37, 160}) {
    const Tensor x = random_tensor({3 * width}, 1, 3.0f), gh = random_tensor({3 * width}, 2),
                 h = random_tensor({width}, 3);
    std::vector<std::vector<float>> results;
    for (const auto set : usable_instruction_sets()) {
      const auto kernels = elementwise::kernels_for(set);
      std::vector<float> y(static_cast<std::size_t>(5 * width));
      kernels.layer_norm_row(x.data(), gh.data(), h.data(), 1e-5, width, y.data());
      kernels.softmax_row(x.data(), width, y.data() + width);
      kernels.gru_row(x.data(), gh.data(), h.data(), width, y.data() + 2 * width);
      y.push_back(kernels.exp_row(x.data(), width, y.data() + 3 * width));
      float scores[3];
      kernels.band_row({.q = h.data(),
                        .k = x.data(),
                        .v = gh.data(),
                        .k_stride = width,
                        .v_stride = width,
                        .heads = 1,
                        .width = width,
                        .count = 3,
                        .scores = scores,
                        .out = y.data() + 4 * width});
      results.push_back(y);
      EXPECT_TRUE(same_bits(y, results.front())) << instruction_set_name(set) << ", width " << width;
    }
  }
}

TEST(Rows, SoftmaxOfARowWithNanIsNan) {
  for (const auto set : usable_instruction_sets()) {
    for (const std::int64_t at : {0, 1, 15, 16, 36}) {
      Tensor x = random_tensor({37}, 4);
      x.data()[at] = std::numeric_limits<float>::quiet_NaN();
      std::vector<float> y(37);
      elementwise::kernels_for(set).softmax_row(x.data(), 37, y.data());
      for (const float v : y) EXPECT_TRUE(std::isnan(v)) << instruction_set_name(set) << ", NaN at " << at;
    }
  }
}

// The neighbours above and below that have 16 bits, and the nearer of them; of two equally near the even one.
TEST(Rows, RoundsToTheNearestBfloat16) {
  std::vector<float> values = {0.0f,   -0.0f,   1.0f, 1.00390625f, 1.01171875f, -1.00390625f,    3.14159f,
                               1e-40f, -1e-45f, kInf, -kInf,       3.4e38f,     0x1.fffffep127f, 65504.0f};
  const Tensor random = random_tensor({200}, 5, 10.0f);
  values.insert(values.end(), random.data(), random.data() + random.count());
  const auto wide = [](std::uint32_t high) { return std::bit_cast<float>(high << 16); };
  for (const auto set : usable_instruction_sets()) {
    std::vector<std::uint16_t> got(values.size());
    elementwise::kernels_for(set).round_to_bfloat16(values.data(), got.data(),
                                                    static_cast<std::int64_t>(values.size()));
    for (std::size_t i = 0; i < values.size(); ++i) {
      const std::uint32_t below = std::bit_cast<std::uint32_t>(values[i]) >> 16;
      // Beyond the largest number lies what would be the next one: infinity counts as 2^128.
      const auto size = [&](std::uint32_t high) {
        return std::isinf(wide(high)) ? 0x1p128 : std::abs(static_cast<double>(wide(high)));
      };
      const double own = std::isinf(values[i]) ? 0x1p128 : std::abs(static_cast<double>(values[i]));
      const double down = own - size(below), up = size(below + 1) - own;
      const std::uint32_t want = down < up || (down == up && below % 2 == 0) ? below : below + 1;
      EXPECT_EQ(got[i], std::isinf(values[i]) ? below : want)
          << instruction_set_name(set) << ", " << values[i];
    }
    const float nan = std::bit_cast<float>(0x7f800001u);
    std::uint16_t one = 0;
    elementwise::kernels_for(set).round_to_bfloat16(&nan, &one, 1);
    EXPECT_TRUE(std::isnan(wide(one)));
  }
}

TEST(Convolution, EqualsItsDefinition) {
  const std::int64_t inputs = 3, outputs = 4, kernel = 3, frames = 11;
  const Tensor x = random_tensor({frames, inputs}, 1), weight = random_tensor({outputs, inputs, kernel}, 2),
               bias = random_tensor({outputs}, 3);
  const PackedMatrix packed(tap_major(weight));
  for (const std::int64_t dilation : {1, 2, 4}) {
    const Tensor y = conv_rows(x, packed, bias, kernel, dilation);
    ASSERT_EQ(y.shape(), (Shape{frames - 2 * dilation, outputs}));
    for (std::int64_t n = 0; n < y.size(0); ++n) {
      for (std::int64_t o = 0; o < outputs; ++o) {
        auto sum = static_cast<double>(bias.data()[o]);
        for (std::int64_t i = 0; i < inputs; ++i)
          for (std::int64_t j = 0; j < kernel; ++j)
            sum += static_cast<double>(weight.data()[(o * inputs + i) * kernel + j]) *
                   static_cast<double>(x.row(n + j * dilation)[static_cast<std::size_t>(i)]);
        EXPECT_NEAR(y.row(n)[static_cast<std::size_t>(o)], sum, 2e-6);
      }
    }
    const Tensor unfolded = linear(unfold_rows(x, kernel, dilation), packed, bias);
    EXPECT_TRUE(same_bits(unfolded.values(), y.values())) << "dilation " << dilation;
  }
  EXPECT_EQ(conv_rows(rows(x, 0, 2), packed, bias, kernel, 1).shape(), (Shape{0, outputs}));
  EXPECT_EQ(conv_rows(rows(x, 0, 4), packed, bias, kernel, 2).shape(), (Shape{0, outputs}));
  EXPECT_THROW((void)conv_rows(x, packed, bias, 2, 1), std::logic_error);
}

TEST(Moves, JoinAndCut) {
  const Tensor a({2, 2}, std::vector<float>{1, 2, 3, 4}), b({2, 1}, std::vector<float>{8, 9});
  const Tensor parts[] = {a, b, a};
  EXPECT_THAT(concat_last(parts).row(1), ElementsAre(3, 4, 9, 3, 4));
  EXPECT_THROW((void)concat_last({}), std::logic_error);
  const Tensor uneven[] = {a, Tensor({3, 1})};
  EXPECT_THROW((void)concat_last(uneven), std::logic_error);
  EXPECT_THAT(concat_rows(a, Tensor({1, 2}, std::vector<float>{5, 6})).values(),
              ElementsAre(1, 2, 3, 4, 5, 6));
  EXPECT_EQ(concat_rows(Tensor({0, 2}), Tensor({0, 2})).shape(), (Shape{0, 2}));
  EXPECT_THROW((void)concat_rows(a, b), std::logic_error);
  EXPECT_THAT(rows(a, 1, 1).values(), ElementsAre(3, 4));
  EXPECT_EQ(rows(a, 2, 0).shape(), (Shape{0, 2}));
  EXPECT_THROW((void)rows(a, 1, 2), std::logic_error);
  EXPECT_THROW((void)rows(a, -1, 1), std::logic_error);
  EXPECT_THAT(columns(a, 1, 1).values(), ElementsAre(2, 4));
  EXPECT_THROW((void)columns(a, 0, 3), std::logic_error);
  const Tensor batch({2, 2, 1}, std::vector<float>{1, 2, 3, 4});
  EXPECT_THAT(rows(batch, 1, 1).values(), ElementsAre(2, 4));
  EXPECT_THAT(concat_rows(batch, rows(batch, 0, 1)).values(), ElementsAre(1, 2, 1, 3, 4, 3));
}

TEST(Moves, LookUpAndInterpolate) {
  const Tensor table({3, 2}, std::vector<float>{0, 10, 2, 30, 4, kNan});
  EXPECT_THAT(embedding_rows(table, std::vector<std::int64_t>{1, 0}).values(), ElementsAre(2, 30, 0, 10));
  EXPECT_THROW((void)embedding_rows(table, std::vector<std::int64_t>{3}), std::logic_error);
  EXPECT_EQ(embedding_rows(table, {}).shape(), (Shape{0, 2}));
  EXPECT_THAT(interpolate_rows(table, std::vector<double>{-5.0, 0.25, 1.0}).values(),
              ElementsAre(0, 10, 0.5f, 15, 2, 30));
  EXPECT_THAT(interpolate_rows(columns(table, 0, 1), std::vector<double>{1.5, 2.0, 99.0}).values(),
              ElementsAre(3, 4, 4));
  EXPECT_EQ(interpolate_rows(Tensor({0, 2}), {}).shape(), (Shape{0, 2}));
  EXPECT_THROW((void)interpolate_rows(Tensor({0, 2}), std::vector<double>{0.0}), std::logic_error);
  EXPECT_THROW((void)interpolate_rows(table, std::vector<double>{std::nan("")}), std::logic_error);
}

// Everything a network does to a row, on 23 rows at once and on any part of them: the same bits.
TEST(Rows, KeepTheirBitsWhateverTheirNumber) {
  const std::int64_t width = 37;
  const Tensor x = random_tensor({23, width}, 1, 2.0f), gamma = random_tensor({width}, 2),
               row = random_tensor({width}, 3);
  const PackedMatrix w(random_tensor({width, width}, 4)), w3(random_tensor({3 * width, width}, 5)),
      taps(random_tensor({width, 3 * width}, 6));
  const Tensor b3 = random_tensor({3 * width}, 7);
  const std::pair<const char*, std::function<Tensor(const Tensor&)>> operations[] = {
      {"linear", [&](const Tensor& t) { return linear(t, w, row); }},
      {"layer_norm", [&](const Tensor& t) { return layer_norm(t, gamma, row); }},
      {"softmax_last", [&](const Tensor& t) { return softmax_last(t); }},
      {"gelu", [&](const Tensor& t) { return gelu(t); }},
      {"silu", [&](const Tensor& t) { return silu(t); }},
      {"tanh", [&](const Tensor& t) { return tanh(t); }},
      {"mul", [&](const Tensor& t) { return mul(t, row); }},
      {"gru_step", [&](const Tensor& t) { return gru_step(t, scale(t, 0.5f), w3, w3, b3, b3); }},
  };
  for (const auto& [name, operation] : operations) {
    const Tensor whole = operation(x);
    for (const std::int64_t count : {1, 2, 5, 7, 12, 22}) {
      const std::int64_t first = 23 - count;
      EXPECT_TRUE(same_bits(operation(rows(x, first, count)).values(), rows(whole, first, count).values()))
          << name << ", " << count << " rows";
    }
  }
  const Tensor whole = conv_rows(x, taps, row, 3, 2);
  for (std::int64_t n = 0; n < whole.size(0); ++n)
    EXPECT_TRUE(same_bits(conv_rows(rows(x, n, 5), taps, row, 3, 2).values(), rows(whole, n, 1).values()))
        << n;
}

TEST(GroupRows, JoinsNeighboursAndWantsWholeGroups) {
  const Tensor x({4, 1}, std::vector<float>{1, 2, 3, 4});
  EXPECT_THAT(group_rows(x, 2).row(1), ElementsAre(3, 4));
  EXPECT_EQ(group_rows(Tensor({0, 3}), 2).shape(), (Shape{0, 6}));
  EXPECT_THROW(group_rows(x, 3), std::logic_error);
}

TEST(ConvolveColumns, CorrelatesWithZerosOutside) {
  const Tensor x({2, 3}, std::vector<float>{1, 2, 3, 0, 0, 1}),
      taps({1, 1, 3}, std::vector<float>{1, 10, 100});
  const Tensor y = convolve_columns(x, taps, Tensor({1}, std::vector<float>{0.5f}));
  EXPECT_THAT(y.row(0), ElementsAre(210.5f, 321.5f, 32.5f));
  EXPECT_THAT(y.row(1), ElementsAre(0.5f, 100.5f, 10.5f));
  const Tensor one = convolve_columns(Tensor({1, 1}, std::vector<float>{2}),
                                      Tensor({5}, std::vector<float>{1, 1, 3, 1, 1}), Tensor({1}));
  EXPECT_EQ(one.data()[0], 6) << "narrower than the taps";
  EXPECT_THROW(convolve_columns(x, Tensor({2}), Tensor({1})), std::logic_error);
}

TEST(MaxPoolPairs, TakesTheLargerAndKeepsNan) {
  const Tensor y = max_pool_pairs(Tensor({1, 6}, std::vector<float>{1, 2, 4, 3, kNan, 1}));
  EXPECT_EQ(y.data()[0], 2);
  EXPECT_EQ(y.data()[1], 4);
  EXPECT_TRUE(std::isnan(y.data()[2]));
  EXPECT_TRUE(std::isnan(max_pool_pairs(Tensor({1, 2}, std::vector<float>{1, kNan})).data()[0]));
  EXPECT_THROW(max_pool_pairs(Tensor({1, 3})), std::logic_error);
  const Tensor means = mean_pool_pairs(Tensor({1, 6}, std::vector<float>{1, 2, -4, 3, kNan, 1}));
  EXPECT_EQ(means.data()[0], 1.5f);
  EXPECT_EQ(means.data()[1], -0.5f);
  EXPECT_TRUE(std::isnan(means.data()[2]));
}

TEST(GeluTanh, IsTheTanhFormEverywhere) {
  const std::vector<float> values = {0.0f, -0.0f, 0.3f, -0.3f, 1.0f,  -1.0f,
                                     2.7f, -2.7f, 6.0f, -6.0f, 50.0f, -50.0f};
  const Tensor x({static_cast<std::int64_t>(values.size())}, values), y = gelu_tanh(x);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double v = values[i];
    const double want =
        0.5 * v * (1 + std::tanh(std::sqrt(2 / 3.141592653589793) * (v + 0.044715 * v * v * v)));
    EXPECT_NEAR(y.values()[i], want, 2e-7 * (1 + std::abs(v))) << v;
  }
  EXPECT_TRUE(std::isnan(gelu_tanh(Tensor({1}, {&kNan, 1})).values()[0]));
}

TEST(Transposed, TurnsRowsIntoColumns) {
  for (const auto& [height, width] : {std::pair<std::int64_t, std::int64_t>{3, 5}, {16, 32}, {37, 18}}) {
    const Tensor x = random_tensor({height, width}, 1), y = transposed(x);
    EXPECT_EQ(y.shape(), (Shape{width, height}));
    for (std::int64_t r = 0; r < height; ++r)
      for (std::int64_t c = 0; c < width; ++c)
        EXPECT_EQ(y.data()[height * c + r], x.data()[width * r + c]) << r << " " << c;
  }
  EXPECT_EQ(transposed(Tensor({0, 4})).shape(), (Shape{4, 0}));
  EXPECT_THROW(transposed(Tensor({2, 2, 2})), std::logic_error);
}

}  // namespace
}  // namespace mien
