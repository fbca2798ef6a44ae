#include "mien/tensor/matmul.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <vector>

#include "backends.h"
#include "mien/base/random.h"
#include "rowwise_dispatch.h"

namespace mien {

// Found by the type's namespace: names of tests say "eigen", not bytes.
static void PrintTo(Backend backend, std::ostream* out) { *out << backend_name(backend); }

namespace {

std::vector<float> random_values(std::int64_t count, std::uint64_t seed) {
  std::vector<float> values(static_cast<std::size_t>(count));
  NoiseField(seed, 0).normal(0, 0, values);
  return values;
}

struct Problem {
  std::int64_t m, k, n;
  std::vector<float> x, w, bias;
  Problem(std::int64_t rows, std::int64_t inputs, std::int64_t outputs)
      : m(rows),
        k(inputs),
        n(outputs),
        x(random_values(m * k, 1)),
        w(random_values(n * k, 2)),
        bias(random_values(n, 3)) {}

  [[nodiscard]] View view() const { return {x.data(), m, k, k}; }
  [[nodiscard]] PackedMatrix packed(Backend backend) const { return {w, n, k, backend}; }
  [[nodiscard]] std::vector<float> run(Backend backend, bool with_bias = true, int num_threads = 1) const {
    std::vector<float> y(static_cast<std::size_t>(m * n), -1.0f);
    matmul(view(), packed(backend), with_bias ? bias.data() : nullptr, y.data(), num_threads);
    return y;
  }
  /// Largest error against sums in double, in units of sqrt(K).
  [[nodiscard]] double error_of(const std::vector<float>& y, bool with_bias = true) const {
    double worst = 0;
    for (std::int64_t i = 0; i < m; ++i) {
      for (std::int64_t j = 0; j < n; ++j) {
        double sum = with_bias ? static_cast<double>(bias[static_cast<std::size_t>(j)]) : 0.0;
        for (std::int64_t l = 0; l < k; ++l)
          sum += static_cast<double>(x[static_cast<std::size_t>(i * k + l)]) *
                 static_cast<double>(w[static_cast<std::size_t>(j * k + l)]);
        const double error = std::abs(sum - static_cast<double>(y[static_cast<std::size_t>(i * n + j)]));
        worst = std::max(worst, std::isnan(error) ? 1e9 : error);
      }
    }
    return worst / std::sqrt(static_cast<double>(k));
  }
};

class EveryBackend : public testing::TestWithParam<Backend> {
 protected:
  void SetUp() override {
    if (!backend_available(GetParam())) GTEST_SKIP() << backend_name(GetParam()) << " is not available here";
  }
  /// Measured on random normal data, times about 3: the precision of the backend.
  [[nodiscard]] double tolerance() const {
    if (GetParam() == Backend::onednn_bf16) return 0.03;
    if (GetParam() == Backend::onednn_int8) return 0.15;
    return 1e-5;
  }
};

INSTANTIATE_TEST_SUITE_P(, EveryBackend,
                         testing::Values(Backend::rowwise, Backend::onednn, Backend::onednn_bf16,
                                         Backend::onednn_int8, Backend::eigen),
                         [](const auto& param) { return std::string(backend_name(param.param)); });

TEST_P(EveryBackend, AgreesWithDoublePrecision) {
  for (const auto [m, k, n] : {std::array{1, 1, 1},
                               {1, 480, 160},
                               {7, 64, 55},
                               {37, 33, 17},
                               {12, 160, 160},
                               {5, 3, 200},
                               {100, 7, 31},
                               {64, 256, 48}}) {
    const Problem p(m, k, n);
    EXPECT_LT(p.error_of(p.run(GetParam())), tolerance()) << m << " " << k << " " << n;
    EXPECT_LT(p.error_of(p.run(GetParam(), false), false), tolerance()) << m << " " << k << " " << n;
  }
}

TEST_P(EveryBackend, TakesNoRowsNoInputsAndNoOutputs) {
  EXPECT_TRUE(Problem(0, 8, 8).run(GetParam()).empty());
  EXPECT_TRUE(Problem(3, 8, 0).run(GetParam()).empty());
  const Problem no_inputs(2, 0, 5);
  const auto y = no_inputs.run(GetParam());
  for (std::size_t i = 0; i < 10; ++i) EXPECT_EQ(y[i], no_inputs.bias[i % 5]);
  EXPECT_EQ(no_inputs.run(GetParam(), false), std::vector<float>(10, 0.0f));
}

TEST_P(EveryBackend, ReadsRowsApart) {
  const Problem p(9, 40, 24);
  std::vector<float> wide(9 * 50, std::numeric_limits<float>::quiet_NaN());
  for (std::size_t i = 0; i < 9; ++i) std::copy_n(p.x.data() + i * 40, 40, wide.data() + i * 50);
  std::vector<float> y(9 * 24);
  matmul({wide.data(), 9, 40, 50}, p.packed(GetParam()), p.bias.data(), y.data());
  EXPECT_LT(p.error_of(y), tolerance());
}

// As a convolution sees its input: each row begins within the one before.
TEST_P(EveryBackend, ReadsRowsThatOverlap) {
  Problem p(9, 40, 24);
  const auto run = random_values(8 * 16 + 40, 4);
  for (std::size_t i = 0; i < 9; ++i) std::copy_n(run.data() + i * 16, 40, p.x.data() + i * 40);
  std::vector<float> y(9 * 24);
  matmul({run.data(), 9, 40, 16}, p.packed(GetParam()), p.bias.data(), y.data());
  EXPECT_LT(p.error_of(y), tolerance());
  EXPECT_EQ(y, p.run(GetParam()));
}

TEST_P(EveryBackend, SpoilsOnlyTheRowThatHoldsNan) {
  Problem p(8, 32, 20);
  p.x[3 * 32 + 5] = std::numeric_limits<float>::quiet_NaN();
  const auto y = p.run(GetParam());
  for (std::size_t i = 0; i < y.size(); ++i) EXPECT_EQ(std::isnan(y[i]), i / 20 == 3) << i;
}

TEST_P(EveryBackend, UsesThreadsForLargeProducts) {
  const Problem tall(300, 200, 150), flat(2, 2000, 2100);
  EXPECT_LT(tall.error_of(tall.run(GetParam(), true, 3)), tolerance());
  EXPECT_LT(flat.error_of(flat.run(GetParam(), true, 3)), tolerance());
}

TEST_P(EveryBackend, RefusesTheWrongWidth) {
  const Problem p(2, 8, 4);
  std::vector<float> y(8);
  EXPECT_THROW(matmul({p.x.data(), 2, 7, 7}, p.packed(GetParam()), nullptr, y.data()), std::logic_error);
  EXPECT_THROW(PackedMatrix(p.w, 5, 8, GetParam()), std::logic_error);
}

// What makes streaming equal offline: a row alone, and among any number of others, has the same bits.
TEST(Rowwise, RowsHaveTheSameBitsWhateverTheirNumber) {
  for (const auto [k, n] : {std::array{160, 160}, {77, 55}, {480, 97}, {3, 1}, {64, 300}}) {
    const Problem whole(37, k, n);
    const auto all = whole.run(Backend::rowwise);
    const auto packed = whole.packed(Backend::rowwise);
    for (std::int64_t m = 1; m <= 37; ++m) {
      std::vector<float> y(static_cast<std::size_t>(m * n));
      const std::int64_t first = 37 - m;  // a window at another place, so other tiles meet the rows
      matmul({whole.x.data() + first * k, m, k, k}, packed, whole.bias.data(), y.data());
      ASSERT_TRUE(std::equal(y.begin(), y.end(), all.begin() + first * n)) << "M = " << m << ", K = " << k;
    }
  }
}

TEST(RowwiseBf16, RowsHaveTheSameBitsWhateverTheirNumber) {
  if (!rowwise_bf16_available()) GTEST_SKIP() << "this processor does not multiply bfloat16";
  for (const auto [k, n] : {std::array{160, 160}, {77, 55}, {3, 1}, {64, 300}}) {
    const Problem whole(37, k, n);
    const auto all = whole.run(Backend::onednn_bf16);
    EXPECT_EQ(whole.run(Backend::onednn_bf16, true, 3), all);
    const auto packed = whole.packed(Backend::onednn_bf16);
    for (std::int64_t m = 1; m <= 37; ++m) {
      std::vector<float> y(static_cast<std::size_t>(m * n));
      const std::int64_t first = 37 - m;
      matmul({whole.x.data() + first * k, m, k, k}, packed, whole.bias.data(), y.data());
      ASSERT_TRUE(std::equal(y.begin(), y.end(), all.begin() + first * n)) << "M = " << m << ", K = " << k;
    }
  }
}

// The kernel of other processors rounds the same numbers: only the order of sums differs.
TEST(RowwiseBf16, AgreesWithOnednn) {
  if (!rowwise_bf16_available() || !onednn_available(Backend::onednn_bf16))
    GTEST_SKIP() << "there are not both kernels here";
  for (const auto [m, k, n] : {std::array{9, 40, 24}, {1, 7, 3}, {50, 576, 192}}) {
    const Problem p(m, k, n);
    const auto own = make_rowwise_bf16_kernel(p.w.data(), n, k),
               theirs = make_onednn_kernel(p.w.data(), n, k, Backend::onednn_bf16);
    for (const View& x : {p.view(), View{p.x.data(), m / 2 + 1, k, k / 2}}) {  // and rows that overlap
      const auto count = static_cast<std::size_t>(x.rows * n);
      std::vector<float> a(count), b(count);
      own->run(x, p.bias.data(), a.data(), 1);
      theirs->run(x, p.bias.data(), b.data(), 1);
      for (std::size_t i = 0; i < count; ++i) ASSERT_NEAR(a[i], b[i], 1e-4) << m << ' ' << k << ' ' << i;
    }
  }
}

TEST(Rowwise, ThreadsDoNotChangeBits) {
  const Problem tall(301, 200, 150), flat(2, 2000, 2100);
  for (const Problem* p : {&tall, &flat}) {
    const auto one = p->run(Backend::rowwise, true, 1);
    for (const int threads : {2, 3, 7}) EXPECT_EQ(p->run(Backend::rowwise, true, threads), one) << threads;
  }
}

TEST(Rowwise, EveryInstructionSetGivesTheChainOfFusedMultiplyAdds) {
  for (const auto [m, k, n] : {std::array{1, 50, 250},
                               {2, 50, 170},
                               {3, 50, 130},
                               {4, 50, 100},
                               {5, 50, 65},
                               {6, 50, 64},
                               {13, 31, 79}}) {
    const Problem p(m, k, n);
    std::vector<float> expected(static_cast<std::size_t>(m * n));
    for (std::int64_t i = 0; i < m; ++i) {
      for (std::int64_t j = 0; j < n; ++j) {
        float sum = p.bias[static_cast<std::size_t>(j)];
        for (std::int64_t l = 0; l < k; ++l)
          sum = std::fma(p.x[static_cast<std::size_t>(i * k + l)], p.w[static_cast<std::size_t>(j * k + l)],
                         sum);
        expected[static_cast<std::size_t>(i * n + j)] = sum;
      }
    }
    const auto panels = rowwise::pack_panels(p.w.data(), n, k);
    for (const auto set : usable_instruction_sets()) {
      std::vector<float> y(expected.size());
      const std::int64_t num_panels = (n + rowwise::kPanel - 1) / rowwise::kPanel;
      rowwise::multiply_for(set)(
          {p.x.data(), k, m, panels.get(), num_panels, k, p.bias.data(), y.data(), n, n});
      EXPECT_EQ(y, expected) << instruction_set_name(set) << ", " << m << " rows";
    }
  }
}

TEST(PackedMatrix, GivesItsWeightsBack) {
  Tensor w({19, 5});
  for (std::int64_t i = 0; i < w.count(); ++i) w.data()[i] = static_cast<float>(i);
  const PackedMatrix packed(w);
  const Tensor all = packed.unpacked(), some = packed.unpacked(1, 3);
  for (std::int64_t i = 0; i < w.count(); ++i) ASSERT_EQ(all.data()[i], w.data()[i]);
  EXPECT_EQ(some.row(18)[0], w.row(18)[1]);
  EXPECT_EQ(packed.unpacked(5, 0).count(), 0);
  EXPECT_THROW((void)packed.unpacked(4, 2), std::logic_error);
  if (!backend_available(Backend::eigen)) return;
  EXPECT_THROW((void)PackedMatrix(w, Backend::eigen).unpacked(), std::logic_error);
}

}  // namespace
}  // namespace mien
