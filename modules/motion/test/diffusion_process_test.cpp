#include "mien/motion/diffusion_process.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "mien/motion/sampler.h"

namespace mien {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(DiffusionProcess, LevelsMultiplyUp) {
  const DiffusionProcess process({0.1, 0.5});
  EXPECT_NEAR(process.alpha_bar(1), 0.9 * 0.5, 1e-15);
  EXPECT_EQ(process.alpha_bar(-1), 1);
  const auto levels = process.sampling_levels();
  ASSERT_EQ(levels.size(), 3u);
  EXPECT_NEAR(levels[0].alpha * levels[0].alpha, 0.45, 1e-15);
  EXPECT_EQ(levels[2].sigma, 0);
  EXPECT_EQ(process.sampling_levels(1).size(), 2u);
  EXPECT_THROW((void)process.sampling_levels(2), std::logic_error);
  EXPECT_THROW(DiffusionProcess({}), std::logic_error);
  EXPECT_THROW(DiffusionProcess({1.0}), std::logic_error);
}

TEST(DiffusionProcess, InFloat32HasOnlyFloats) {
  const auto betas = betas_of(BetaSchedule::cosine, 1000);
  const auto process = DiffusionProcess::in_float32(betas);
  double product = 1;
  for (std::int64_t i = 0; i < 1000; ++i) {
    product *= static_cast<double>(1.0f - static_cast<float>(betas[static_cast<std::size_t>(i)]));
    EXPECT_EQ(process.alpha_bar(i), static_cast<double>(static_cast<float>(product)));
  }
}

TEST(DiffusionProcess, RespacedKeepsLevelsAndNetworkSteps) {
  const DiffusionProcess process(betas_of(BetaSchedule::linear, 100));
  const std::vector<std::int64_t> kept = {0, 30, 99};
  const DiffusionProcess shorter = process.respaced(kept);
  ASSERT_EQ(shorter.size(), 3);
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(shorter.alpha_bar(i), process.alpha_bar(kept[i]), 1e-14);
    EXPECT_EQ(shorter.network_step(i), kept[i]);
  }
  EXPECT_EQ(shorter.num_network_steps(), 100);
}

TEST(DiffusionProcess, PosteriorIsTheSamplersAncestralStep) {
  const DiffusionProcess process(betas_of(BetaSchedule::cosine, 50));
  const auto steps = plan_sampling({.kind = SamplerKind::ancestral}, process.sampling_levels());
  ASSERT_EQ(steps.size(), 50u);
  for (std::int64_t i = 0; i < 50; ++i) {
    const SampleStep& step = steps[static_cast<std::size_t>(49 - i)];
    EXPECT_NEAR(step.x0, process.posterior_x0_weight(i), 1e-12) << i;
    EXPECT_NEAR(step.x, process.posterior_x_weight(i), 1e-12) << i;
    EXPECT_NEAR(step.noise, std::sqrt(process.posterior_variance(i)), 1e-12) << i;
  }
  EXPECT_EQ(process.posterior_log_variance(0), process.posterior_log_variance(1));
}

TEST(RespacedSteps, FollowTheTwoRules) {
  EXPECT_THAT(*respaced_steps("ddim4", 10), ElementsAre(0, 3, 6, 9));
  EXPECT_THAT(*respaced_steps("3", 10), ElementsAre(0, 4, 9)) << "4.5 rounds to the even 4";
  EXPECT_THAT(*respaced_steps("1,2", 5), ElementsAre(0, 3, 4)) << "the first section is one longer";
  EXPECT_THAT(*respaced_steps("", 3), ElementsAre(0, 1, 2));
}

TEST(RespacedSteps, RefuseWhatCannotBe) {
  for (const char* rule : {"ddim", "ddim0", "ddim7", "ddim-1", "x", "5,", ",5", "11", "3,6", "1e1", "2.5",
                           "99999999999999999999"}) {
    const auto steps = respaced_steps(rule, 10);
    ASSERT_FALSE(steps) << rule;
    EXPECT_EQ(steps.error().code, Errc::usage);
    EXPECT_THAT(steps.error().message(), HasSubstr(rule));
  }
}

}  // namespace
}  // namespace mien
