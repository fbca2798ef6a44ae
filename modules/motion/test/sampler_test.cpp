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

// A network may tell x0, the noise or the velocity: the walk is the same.
TEST(Sampler, TakesEveryPrediction) {
  const auto run = [](SamplerKind kind, Prediction prediction) {
    const Denoiser best = [&](int, NoiseLevel l, std::span<const float> x, std::span<float> out) {
      for (std::size_t i = 0; i < x.size(); ++i) {
        const double x0 = 0.3 * l.alpha * x[i] / (0.3 * l.alpha * l.alpha + l.sigma * l.sigma);
        const double epsilon = (x[i] - l.alpha * x0) / l.sigma;
        out[i] = static_cast<float>(prediction == Prediction::x0        ? x0
                                    : prediction == Prediction::epsilon ? epsilon
                                                                        : l.alpha * epsilon - l.sigma * x0);
      }
    };
    const NoiseField field(5, 0);
    std::vector<float> x(50);
    field.normal(0, 0, x);
    const StepNoise noise = [&](int step, std::span<float> out) {
      field.normal(0, static_cast<unsigned>(step) + 1, out);
    };
    sample_diffusion({.kind = kind, .eta = 0.5, .prediction = prediction}, cosine_grid(12, 1.0), best, noise,
                     x);
    return x;
  };
  for (const auto kind : {SamplerKind::ancestral, SamplerKind::ddim, SamplerKind::dpmpp_2m}) {
    const auto want = run(kind, Prediction::x0);
    for (const auto prediction : {Prediction::epsilon, Prediction::velocity}) {
      const auto got = run(kind, prediction);
      for (std::size_t i = 0; i < want.size(); ++i) EXPECT_NEAR(got[i], want[i], 2e-5) << i;
    }
  }
}

// One step by hand (diffusers' DDIM): x0 is clipped, the noise it goes on with is not touched.
TEST(Sampler, KeepsTheNetworksNoiseWhereX0IsClipped) {
  const NoiseLevel from{0.6, 0.8}, to{0.8, 0.6};
  const std::vector<NoiseLevel> levels = {from, to};
  const Denoiser network = [](int, NoiseLevel, std::span<const float>, std::span<float> out) {
    out[0] = -0.5f;
  };
  SamplerOptions options{.kind = SamplerKind::ddim, .prediction = Prediction::epsilon};
  options.clip_x0 = {.low = -1, .high = 1};
  options.keeps_epsilon = true;
  std::vector<float> x = {1.0f};  // x0 = (1 + 0.4) / 0.6, clipped to 1
  sample_diffusion(options, levels, network, nullptr, x);
  EXPECT_NEAR(x[0], 0.8 * 1 + 0.6 * -0.5, 1e-6);
  options.keeps_epsilon = false;  // the noise of x0 = 1 is (1 - 0.6) / 0.8 = 0.5
  x = {1.0f};
  sample_diffusion(options, levels, network, nullptr, x);
  EXPECT_NEAR(x[0], 0.8 * 1 + 0.6 * 0.5, 1e-6);
}

TEST(Sampler, EditsAfterEveryStepAtTheLevelReached) {
  const auto levels = cosine_grid(3, 1.0);
  const Denoiser zero = [](int, NoiseLevel, std::span<const float>, std::span<float> x0) { x0[0] = 0; };
  std::vector<double> reached;
  std::vector<float> x = {1};
  sample_diffusion({}, levels, zero, nullptr, x, [&](int step, NoiseLevel level, std::span<float> values) {
    EXPECT_EQ(static_cast<std::size_t>(step), reached.size());
    reached.push_back(level.sigma);
    values[0] = static_cast<float>(step);
  });
  EXPECT_EQ(reached, (std::vector<double>{levels[1].sigma, levels[2].sigma, 0}));
  EXPECT_EQ(x[0], 2) << "the last edit stands";
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
