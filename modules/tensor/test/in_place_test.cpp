#include "mien/tensor/in_place.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "elementwise_dispatch.h"
#include "mien/base/random.h"
#include "mien/tensor/ops.h"

// What fast paths compute on memory of their own, against the operations of ops.h, on every instruction set.
namespace mien {
namespace {

Tensor noise(Shape shape, std::uint32_t stream, float size = 1.0f, float centre = 0.0f) {
  Tensor x = Tensor::uninitialized(std::move(shape));
  NoiseField(9, stream).normal(0, 0, x.values());
  for (float& v : x.values()) v = v * size + centre;
  return x;
}

bool same_bits(std::span<const float> a, std::span<const float> b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size_bytes()) == 0);
}

struct Norm {
  std::int64_t rows, width, groups;
  float size = 1, centre = 0;
};

class GroupNormRows : public testing::TestWithParam<Norm> {};
INSTANTIATE_TEST_SUITE_P(Sizes, GroupNormRows,
                         testing::Values(Norm{240, 192, 32}, Norm{37, 38, 2}, Norm{16, 5, 1},
                                         Norm{17, 64, 64}, Norm{1, 6, 2}, Norm{1000, 12, 3, 0.01f, 0.0f},
                                         Norm{500, 24, 4, 3.0f, 30.0f}));

TEST_P(GroupNormRows, EqualsTheGroupNorm) {
  const auto [rows, width, groups, size, centre] = GetParam();
  const Tensor x = noise({rows, width}, 1, size, centre), gamma = noise({width}, 2), beta = noise({width}, 3);
  Tensor want = group_norm(x, gamma, beta, groups, 1e-6), got(x.shape());
  for (const bool with_silu : {false, true}) {
    if (with_silu) want = silu(want);
    group_norm_rows(x, gamma, beta, {.groups = groups, .eps = 1e-6, .silu = with_silu}, got.data());
    for (std::int64_t i = 0; i < x.count(); ++i)
      ASSERT_NEAR(got.data()[i], want.data()[i], 1e-5) << "value " << i << ", SiLU " << with_silu;
  }
  Tensor in_place = x;
  group_norm_rows(in_place, gamma, beta, {.groups = groups, .eps = 1e-6, .silu = true}, in_place.data());
  EXPECT_TRUE(same_bits(in_place.values(), got.values()));
}

TEST_P(GroupNormRows, HasTheSameBitsOnEveryInstructionSet) {
  const auto [rows, width, groups, size, centre] = GetParam();
  const Tensor x = noise({rows, width}, 1, size, centre), gamma = noise({width}, 2), beta = noise({width}, 3);
  std::vector<std::vector<float>> results;
  for (const auto set : usable_instruction_sets()) {
    std::vector<double> sums(static_cast<std::size_t>(width));
    std::vector<float> means(sums.size()), factors(sums.size()), out(x.values().size());
    elementwise::kernels_for(set).group_norm_rows({.x = x.data(),
                                                   .rows = rows,
                                                   .width = width,
                                                   .groups = groups,
                                                   .gamma = gamma.data(),
                                                   .beta = beta.data(),
                                                   .eps = 1e-5,
                                                   .silu = true,
                                                   .sums = sums.data(),
                                                   .means = means.data(),
                                                   .factors = factors.data(),
                                                   .out = out.data()});
    results.push_back(std::move(out));
    EXPECT_TRUE(same_bits(results.back(), results.front())) << instruction_set_name(set);
  }
}

TEST(GroupNormRows, KeepsNanInItsGroupAndTakesNoRows) {
  Tensor x = noise({40, 8}, 1), out(x.shape());
  const Tensor gamma = noise({8}, 2), beta = noise({8}, 3);
  x.row(21)[5] = std::numeric_limits<float>::quiet_NaN();
  group_norm_rows(x, gamma, beta, {.groups = 2, .silu = true}, out.data());
  for (std::int64_t i = 0; i < x.count(); ++i) EXPECT_EQ(std::isnan(out.data()[i]), i % 8 >= 4) << i;
  group_norm_rows(Tensor({0, 8}), gamma, beta, {.groups = 2}, nullptr);
  EXPECT_THROW(group_norm_rows(x, gamma, beta, {.groups = 3}, out.data()), std::logic_error);
  EXPECT_THROW(group_norm_rows(x, noise({7}, 2), beta, {.groups = 2}, out.data()), std::logic_error);
}

TEST(LayerNormRows, HasTheBitsOfTheLayerNorm) {
  for (const std::int64_t width : {1, 7, 8, 37, 192}) {
    const Tensor x = noise({5, width}, 1, 3.0f), gamma = noise({width}, 2), beta = noise({width}, 3);
    Tensor out(x.shape());
    layer_norm_rows(x.values(), gamma, beta, 1e-5, out.data());
    EXPECT_TRUE(same_bits(out.values(), layer_norm(x, gamma, beta).values())) << width;
    EXPECT_THROW(layer_norm_rows(x.values(), gamma, noise({width + 1}, 3), 1e-5, out.data()),
                 std::logic_error);
  }
}

TEST(GatedGelu, IsTheProductWithTheGelu) {
  for (const std::int64_t count : {0, 1, 15, 16, 37}) {
    const Tensor values = noise({count}, 1), gates = noise({count}, 2, 2.0f);
    const Tensor want = mul(gelu(gates), values);
    Tensor out(values.shape());
    gated_gelu(values.values(), gates.values(), out.data());
    EXPECT_TRUE(same_bits(out.values(), want.values())) << count;
    for (const auto set : usable_instruction_sets()) {
      elementwise::kernels_for(set).gated_gelu(values.data(), gates.data(), count, out.data());
      EXPECT_TRUE(same_bits(out.values(), want.values())) << instruction_set_name(set) << ' ' << count;
    }
  }
  const Tensor five = noise({5}, 1), four = noise({4}, 2);
  Tensor out({5});
  EXPECT_THROW(gated_gelu(five.values(), four.values(), out.data()), std::logic_error);
}

TEST(AddInPlace, Adds) {
  for (const std::int64_t count : {0, 1, 16, 37}) {
    Tensor x = noise({count}, 1);
    const Tensor y = noise({count}, 2), want = add(x, y);
    add_in_place(x.values(), y.values());
    EXPECT_TRUE(same_bits(x.values(), want.values())) << count;
  }
}

// Rounding to 8 bits in steps of max / 127, and back.
TEST(Quantise, RoundsARowToItsSteps) {
  for (const std::int64_t count : {1, 15, 16, 37}) {
    const Tensor x = noise({count}, 1, 2.0f), steps = noise({count}, 2), bias = noise({count}, 3);
    float largest = 0;
    for (const float v : x.values()) largest = std::max(largest, std::abs(v));
    std::vector<std::vector<float>> results;
    for (const auto set : usable_instruction_sets()) {
      const auto kernels = elementwise::kernels_for(set);
      std::vector<std::int8_t> rounded(static_cast<std::size_t>(count));
      EXPECT_EQ(kernels.quantise_row(x.data(), count, rounded.data()), largest / 127.0f);
      std::vector<std::int32_t> sums(rounded.size());
      for (std::size_t i = 0; i < sums.size(); ++i) {
        EXPECT_EQ(rounded[i], std::lrint(x.values()[i] * (127.0f / largest))) << i;
        sums[i] = 1000 * rounded[i];
      }
      std::vector<float> out(sums.size());
      kernels.dequantise_row(sums.data(), 0.25f, steps.data(), bias.data(), count, out.data());
      for (std::size_t i = 0; i < out.size(); ++i)
        EXPECT_NEAR(out[i], 0.25 * sums[i] * steps.values()[i] + bias.values()[i], 1e-6 * std::abs(sums[i]));
      results.push_back(std::move(out));
      EXPECT_TRUE(same_bits(results.back(), results.front())) << instruction_set_name(set);
      float without_bias = 0;
      kernels.dequantise_row(sums.data(), 0.25f, steps.data(), nullptr, 1, &without_bias);
      EXPECT_EQ(without_bias, static_cast<float>(sums[0]) * (0.25f * steps.data()[0]));
    }
  }
}

TEST(Quantise, TellsRowsThatAreNotFinite) {
  for (const auto set : usable_instruction_sets()) {
    const auto quantise = elementwise::kernels_for(set).quantise_row;
    for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                            -std::numeric_limits<float>::infinity()}) {
      for (const std::int64_t at : {0, 15, 16, 36}) {
        Tensor x = noise({37}, 4);
        x.data()[at] = bad;
        std::int8_t out[37];
        EXPECT_TRUE(std::isnan(quantise(x.data(), 37, out))) << bad << " at " << at;
      }
    }
    const float zeros[] = {0, -0.0f, 1e-45f};
    std::int8_t out[] = {1, 1, 1};
    EXPECT_EQ(quantise(zeros, 3, out), 0.0f);
    for (const int v : out) EXPECT_EQ(v, 0);
  }
}

}  // namespace
}  // namespace mien
