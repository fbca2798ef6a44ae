// FD, mixtures, WInD, multimodality and beats on cases whose answers are known.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "../src/k_means.h"
#include "mien/base/random.h"
#include "mien/metrics/beat_consistency.h"
#include "mien/metrics/multimodality.h"
#include "mien/metrics/wind.h"

namespace mien {
namespace {

Gaussian diagonal(std::vector<double> mean, const std::vector<double>& variances) {
  Gaussian g{std::move(mean), std::vector<double>(variances.size() * variances.size(), 0.0)};
  for (std::size_t i = 0; i < variances.size(); ++i) g.covariance[i * variances.size() + i] = variances[i];
  return g;
}

// n rows of N(mean, sd) in every column.
void add_cloud(FeatureTable& table, int n, double mean, double sd, std::uint64_t seed) {
  Rng random(seed);
  for (std::int64_t i = 0; i < n * table.width; ++i) table.values.push_back(random.normal(mean, sd));
}

TEST(FrechetDistance, OfDiagonalGaussiansIsKnown) {
  const Gaussian a = diagonal({1, 2}, {4, 9}), b = diagonal({1, 5}, {1, 0});
  EXPECT_NEAR(frechet_distance(a, b), 9 + (2 - 1) * (2 - 1) + 9, 1e-12);
  EXPECT_NEAR(frechet_distance(a, a), 0, 1e-12);
  EXPECT_NEAR(frechet_distance(a, b), frechet_distance(b, a), 1e-12);
  EXPECT_TRUE(
      std::isnan(frechet_distance(a, diagonal({1, 2}, {std::numeric_limits<double>::quiet_NaN(), 1}))));
  EXPECT_THROW((void)frechet_distance(a, diagonal({1}, {1})), std::logic_error);
}

TEST(GaussianOf, DividesByOneLess) {
  const Gaussian g = gaussian_of({2, {1, 0, 3, 0, 5, 3}});
  EXPECT_EQ(g.mean, (std::vector<double>{3, 1}));
  EXPECT_EQ(g.covariance, (std::vector<double>{4, 3, 3, 3}));
  EXPECT_THROW(gaussian_of({2, {1, 0}}), std::logic_error);
}

TEST(KMeans, FindsCloudsThatLieApart) {
  FeatureTable table{2, {}};
  for (int c = 0; c < 4; ++c) add_cloud(table, 50, 20 * c, 1, 10 + static_cast<std::uint64_t>(c));
  Rng random(1);
  const auto labels = k_means(table, 4, random);
  for (int c = 0; c < 4; ++c)
    for (int i = 0; i < 50; ++i)
      EXPECT_EQ(labels[static_cast<std::size_t>(50 * c + i)], labels[static_cast<std::size_t>(50 * c)]);
  Rng again(1);
  EXPECT_EQ(k_means({1, {7, 7, 7}}, 3, again).size(), 3u);  // equal rows: centres fall together
}

TEST(GaussianMixture, FindsItsComponents) {
  FeatureTable table{3, {}};
  add_cloud(table, 3000, -4, 1, 1), add_cloud(table, 1000, 6, 2, 2);
  const auto mixture = fit_mixture(table, {.num_components = 2, .seed = 5});
  ASSERT_TRUE(mixture);
  const std::size_t heavy = mixture->weights[0] > mixture->weights[1] ? 0 : 1;
  EXPECT_NEAR(mixture->weights[heavy], 0.75, 1e-3);
  const Gaussian &a = mixture->components[heavy], &b = mixture->components[1 - heavy];
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(a.mean[i], -4, 0.1);
    EXPECT_NEAR(b.mean[i], 6, 0.2);
    EXPECT_NEAR(a.covariance[4 * i], 1, 0.1);
    EXPECT_NEAR(b.covariance[4 * i], 4, 0.5);
  }
}

TEST(GaussianMixture, IsNotMadeOfTooLittleOrOfNan) {
  EXPECT_FALSE(fit_mixture({2, {1, 2, 3, 4}}, {.num_components = 3}));
  EXPECT_FALSE(fit_mixture({1, {1, std::numeric_limits<double>::infinity(), 3}}, {.num_components = 1}));
  EXPECT_TRUE(
      fit_mixture({2, {1, 2, 1, 2, 1, 2}}, {.num_components = 2}));  // one point: only the regularisation
}

TEST(Transport, TakesTheCheapestWay) {
  EXPECT_EQ(cheapest_transport({1, 1}, {1, 1}, {1, 2, 2, 1}), (std::vector<double>{1, 0, 0, 1}));
  // The cheapest arc first would cost 1 + 10; the best plan costs 2 + 3.
  EXPECT_EQ(cheapest_transport({1, 1}, {1, 1}, {1, 2, 3, 10}), (std::vector<double>{0, 1, 1, 0}));
  EXPECT_EQ(cheapest_transport({0.5, 0.5}, {0.25, 0.75}, {0, 1, 1, 0}),
            (std::vector<double>{0.25, 0.25, 0, 0.5}));
  EXPECT_EQ(cheapest_transport({0}, {0}, {3}), (std::vector<double>{0}));
}

// Against every way to move three masses of equal size: the six permutations.
TEST(Transport, IsNeverBeatenByAPermutation) {
  Rng random(4);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<double> cost(9);
    for (double& c : cost) c = random.uniform(0, 5);
    const auto plan = cheapest_transport({1, 1, 1}, {1, 1, 1}, cost);
    double got = 0, best = 1e9;
    for (std::size_t i = 0; i < 9; ++i) got += plan[i] * cost[i];
    for (const auto& p : {std::array{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}})
      best = std::min(best, cost[static_cast<std::size_t>(p[0])] + cost[static_cast<std::size_t>(3 + p[1])] +
                                cost[static_cast<std::size_t>(6 + p[2])]);
    EXPECT_NEAR(got, best, 1e-9);
  }
}

TEST(Wind, IsSmallBetweenSamplesOfOneAndGrowsWithTheShift) {
  FeatureTable a{2, {}}, b{2, {}}, shifted{2, {}};
  for (int c = 0; c < 5; ++c) {
    add_cloud(a, 200, 12 * c, 1, 20 + static_cast<std::uint64_t>(c));
    add_cloud(b, 200, 12 * c, 1, 40 + static_cast<std::uint64_t>(c));
    add_cloud(shifted, 200, 12 * c + 3, 1, 60 + static_cast<std::uint64_t>(c));
  }
  const WindScore same = wind(a, b), far = wind(a, shifted);
  EXPECT_LT(same.mean, 0.2);
  EXPECT_NEAR(far.mean, 18, 1.5);  // 3 in both columns, squared
  const WindScore again = wind(a, shifted, {.num_threads = 4});
  EXPECT_EQ(again.mean, far.mean);
  EXPECT_EQ(again.deviation, far.deviation);
  EXPECT_TRUE(std::isnan(wind(a, {2, {1, 1}}).mean));
}

TEST(MultimodalityMeasure, ComparesHalves) {
  Multimodality m;
  EXPECT_TRUE(std::isnan(m.value()));
  m.add_group({1, {0, 1, 5, 3, 100}});  // |0 - 5|, |1 - 3|; the fifth is left out
  EXPECT_EQ(m.num_pairs(), 2);
  EXPECT_DOUBLE_EQ(m.value(), 3.5);
  m.add_group({1, {7}});
  EXPECT_EQ(m.num_pairs(), 2);
}

// Moves fast but for a rest around frames 30 and 60.
FeatureTable resting_motion() {
  FeatureTable t{2, {}};
  double x = 0;
  for (int n = 0; n < 90; ++n) {
    t.values.insert(t.values.end(), {x, 0.0});  // the second channel never moves
    x += std::abs(n - 30) < 1 || std::abs(n - 60) < 1 ? 0.001 : 0.1;
  }
  return t;
}

TEST(BeatConsistency, IsOneWhereMotionRestsAtTheOnsets) {
  const std::vector<BeatSequence> on = {{{0.5, 1.0}, resting_motion()}}, off = {{{0.75}, resting_motion()}};
  EXPECT_NEAR(beat_consistency(on), 1, 1e-12);
  EXPECT_NEAR(beat_consistency(off), std::exp(-0.25 * 0.25 / 0.02), 1e-12);
}

TEST(BeatConsistency, OfMotionWithoutBeatsIsZeroAndWithoutOnsetsUndefined) {
  const FeatureTable still{1, std::vector<double>(50, 0.3)};
  EXPECT_EQ(beat_consistency(std::vector<BeatSequence>{{{0.5}, still}}), 0);
  EXPECT_TRUE(std::isnan(beat_consistency(std::vector<BeatSequence>{{{}, resting_motion()}})));
  EXPECT_TRUE(std::isnan(beat_consistency({})));
  EXPECT_EQ(beat_consistency(std::vector<BeatSequence>{{{0.5}, {1, {0.1}}}}), 0);  // one frame
}

}  // namespace
}  // namespace mien
