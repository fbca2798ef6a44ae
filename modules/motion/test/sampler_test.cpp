#include "mien/motion/sampler.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mien/base/random.h"

namespace mien {
namespace {

TEST(CosineSchedule, RunsFromCleanToNoise) {
  EXPECT_DOUBLE_EQ(cosine_level(0).alpha, 1);
  double last = 1;
  for (int i = 1; i <= 100; ++i) {
    const NoiseLevel level = cosine_level(i / 100.0);
    EXPECT_LT(level.alpha, last);
    EXPECT_NEAR(level.alpha * level.alpha + level.sigma * level.sigma, 1, 1e-12);
    last = level.alpha;
  }
  EXPECT_NEAR(last, 0, 1e-12);
  const auto grid = cosine_grid(8, 1.7);
  ASSERT_EQ(grid.size(), 9u);
  EXPECT_EQ(grid.back().sigma, 0);
  for (std::size_t i = 1; i < grid.size(); ++i) EXPECT_LT(grid[i].sigma, grid[i - 1].sigma);
}

// For data N(mean, sd^2) the best estimate of x0 is known in closed form; a sampler that is right turns noise
// into N(mean, sd^2).
class GaussianData : public testing::TestWithParam<SamplerKind> {};

TEST_P(GaussianData, IsRecovered) {
  constexpr double kMean = 1.5, kSd = 0.5;
  const Denoiser best = [](int, NoiseLevel l, std::span<const float> x, std::span<float> x0) {
    const double gain = l.alpha * kSd * kSd / (l.alpha * l.alpha * kSd * kSd + l.sigma * l.sigma);
    for (std::size_t i = 0; i < x.size(); ++i)
      x0[i] = static_cast<float>(kMean + gain * (static_cast<double>(x[i]) - l.alpha * kMean));
  };
  const NoiseField field(1, 0);
  const StepNoise noise = [&](int step, std::span<float> out) {
    field.normal(0, static_cast<unsigned>(step) + 1, out);
  };
  std::vector<float> x(20000);
  field.normal(0, 0, x);
  auto levels =
      cosine_grid(GetParam() == SamplerKind::ancestral ? 500 : 60, 1.0);  // first order in its noise
  levels.back() = cosine_level(1e-4);  // a clean last level would return a conditional mean
  sample_diffusion({GetParam(), 0}, levels, best, noise, x);
  double sum = 0, square = 0;
  for (const float v : x) sum += v, square += static_cast<double>(v) * v;
  const double mean = sum / 20000, sd = std::sqrt(square / 20000 - mean * mean);
  EXPECT_NEAR(mean, kMean, 0.02);
  EXPECT_NEAR(sd, kSd, 0.02);
}

INSTANTIATE_TEST_SUITE_P(AllKinds, GaussianData,
                         testing::Values(SamplerKind::ancestral, SamplerKind::ddim, SamplerKind::dpmpp_2m));

TEST(Sampler, SecondOrderConvergesFasterThanDdim) {
  const Denoiser best = [](int, NoiseLevel l, std::span<const float> x, std::span<float> x0) {
    const double gain = l.alpha * 0.25 / (l.alpha * l.alpha * 0.25 + l.sigma * l.sigma);
    for (std::size_t i = 0; i < x.size(); ++i) x0[i] = static_cast<float>(gain * static_cast<double>(x[i]));
  };
  const auto run = [&](SamplerKind kind, int steps) {
    std::vector<float> x = {1.0f};
    std::vector<NoiseLevel> levels;  // equal steps of ln(alpha / sigma) from -4 to 4
    for (int i = 0; i <= steps; ++i) {
      const double snr = std::exp(2 * (8.0 * i / steps - 4));
      levels.push_back({std::sqrt(snr / (1 + snr)), std::sqrt(1 / (1 + snr))});
    }
    sample_diffusion({kind, 0}, levels, best, nullptr, x);
    return static_cast<double>(x[0]);
  };
  const double exact = run(SamplerKind::ddim, 4000);
  EXPECT_LT(std::abs(run(SamplerKind::dpmpp_2m, 16) - exact),
            0.5 * std::abs(run(SamplerKind::ddim, 16) - exact));
}

TEST(Sampler, EndsInTheLastEstimateAndChecksItsLevels) {
  const Denoiser constant = [](int, NoiseLevel, std::span<const float>, std::span<float> x0) {
    for (float& v : x0) v = 3;
  };
  std::vector<float> x = {0, 1};
  sample_diffusion({}, cosine_grid(1, 1.0), constant, nullptr, x);
  EXPECT_EQ(x, (std::vector<float>{3, 3}));
  const std::vector<NoiseLevel> one = {{0, 1}};
  EXPECT_THROW(sample_diffusion({}, one, constant, nullptr, x), std::logic_error);
  EXPECT_EQ(parse_sampler("dpm++"), SamplerKind::dpmpp_2m);
  EXPECT_FALSE(parse_sampler("euler"));
}

}  // namespace
}  // namespace mien
