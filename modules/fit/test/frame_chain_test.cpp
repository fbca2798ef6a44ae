#include "../src/frame_chain.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "../src/symmetric_blocks.h"
#include "mien/base/random.h"

namespace mien {
namespace {

// A^T A + I of random numbers.
std::vector<double> random_definite(std::int64_t k, Rng& rng) {
  std::vector<double> a(static_cast<std::size_t>(k * k)), p(a.size());
  for (double& v : a) v = rng.normal();
  for (std::int64_t i = 0; i < k; ++i)
    for (std::int64_t j = 0; j < k; ++j) {
      double sum = i == j;
      for (std::int64_t m = 0; m < k; ++m) sum += a[m * k + i] * a[m * k + j];
      p[i * k + j] = sum;
    }
  return p;
}

TEST(SymmetricBlocks, InvertAndMultiply) {
  Rng rng(1);
  for (const std::int64_t num_blocks : {1, 2, 4, 7}) {
    const std::int64_t k = num_blocks * kBlock;
    const auto p = random_definite(k, rng);
    std::vector<double> blocks(static_cast<std::size_t>(block_offset(num_blocks, 0)));
    for (std::int64_t i = 0; i < k; ++i)
      for (std::int64_t j = 0; j < (i / kBlock + 1) * kBlock; ++j)
        blocks[block_offset(i / kBlock, j / kBlock) + i % kBlock * kBlock + j % kBlock] = p[i * k + j];
    std::vector<double> x(static_cast<std::size_t>(k)), y(x.size()), z(x.size());
    for (double& v : x) v = rng.normal();
    multiply_blocks(blocks.data(), num_blocks, x.data(), y.data());
    multiply_off_diagonal(blocks.data(), num_blocks, x.data(), z.data());
    for (std::int64_t i = 0; i < k; ++i) {
      double sum = 0;
      for (std::int64_t j = 0; j < k; ++j) sum += p[i * k + j] * x[j];
      EXPECT_NEAR(y[i], sum, 1e-11);
      EXPECT_NEAR(z[i], sum - p[i * k + i] * x[i], 1e-11);
    }
    std::vector<double> scratch(static_cast<std::size_t>(2 * k * kBlock)), back(x.size());
    ASSERT_TRUE(invert_blocks(blocks.data(), num_blocks, scratch.data()));
    multiply_blocks(blocks.data(), num_blocks, y.data(), back.data());
    for (std::int64_t i = 0; i < k; ++i) EXPECT_NEAR(back[i], x[i], 1e-9) << num_blocks << ' ' << i;
  }
}

TEST(FrameChain, SolvesWhatItsDefinitionSays) {
  Rng rng(2);
  for (const std::int64_t t : {1, 2, 3, 17}) {
    const std::int64_t k = t == 2 ? 19 : 5;  // one block, three blocks
    const auto p = random_definite(k, rng);
    std::vector<double> d(static_cast<std::size_t>(t * k)), w(static_cast<std::size_t>((t - 1) * k)),
        r(d.size());
    for (double& v : w) v = 10 * rng.uniform();
    for (double& v : d) v = rng.uniform();
    for (double& v : r) v = rng.normal();
    FrameChain chain(p, k, t);
    ASSERT_TRUE(chain.factor(d, w));
    auto x = r;
    std::vector<double> change(w.size());
    chain.solve(x, change);
    for (std::size_t i = 0; i < change.size(); ++i) EXPECT_NEAR(change[i], x[i + k] - x[i], 1e-12);
    for (std::int64_t n = 0; n < t; ++n)
      for (std::int64_t i = 0; i < k; ++i) {
        double left = d[n * k + i] * x[n * k + i];
        for (std::int64_t j = 0; j < k; ++j) left += p[i * k + j] * x[n * k + j];
        if (n > 0) left += w[(n - 1) * k + i] * (x[n * k + i] - x[(n - 1) * k + i]);
        if (n + 1 < t) left += w[n * k + i] * (x[n * k + i] - x[(n + 1) * k + i]);
        EXPECT_NEAR(left, r[n * k + i], 1e-9);
      }
  }
}

TEST(FrameChain, KeepsItsDigitsWhenFramesAreTiedTogether) {
  // With w without bound all frames are one: x = (sum of P + d)^-1 (sum of r).
  Rng rng(4);
  const std::int64_t t = 50, k = 3;
  const auto p = random_definite(k, rng);
  const std::vector<double> d(static_cast<std::size_t>(t * k), 0.0),
      w(static_cast<std::size_t>((t - 1) * k), 1e14);
  std::vector<double> r(d.size());
  for (double& v : r) v = rng.normal();
  FrameChain tied(p, k, t), alone(p, k, 1);
  ASSERT_TRUE(tied.factor(d, w));
  ASSERT_TRUE(alone.factor(std::span(d).first(3), {}));
  std::vector<double> mean(3);
  for (std::size_t i = 0; i < r.size(); ++i) mean[i % 3] += r[i] / t;
  std::vector<double> change(w.size());
  const auto forces = r;
  tied.solve(r, change);
  alone.solve(mean, {});
  // What a tie carries is what the frames before it need to follow.
  double carried = 0;
  for (std::int64_t n = 0; n + 1 < t; ++n) {
    double need = -forces[n * k];
    for (std::int64_t j = 0; j < k; ++j) need += p[j] * r[n * k + j];
    carried += need;
    EXPECT_NEAR(w[0] * change[n * k], carried, 1e-9 * (1 + std::abs(carried)));
  }
  for (std::size_t i = 0; i < r.size(); ++i) EXPECT_NEAR(r[i], mean[i % 3], 1e-9);
}

TEST(FrameChain, SaysWhenASystemIsNotPositiveDefinite) {
  const std::vector<double> p = {1, 2, 2, 1}, d = {0, 0};
  FrameChain chain(p, 2, 1);
  EXPECT_FALSE(chain.factor(d, {}));
  const std::vector<double> nan = {std::nan(""), 0, 0, 1};
  FrameChain broken(nan, 2, 1);
  EXPECT_FALSE(broken.factor(d, {}));
}

}  // namespace
}  // namespace mien
