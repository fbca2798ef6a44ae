// Schedules of FaceDiffuser's diffusion library: every derived array in double, and which steps are kept.
#include <gtest/gtest.h>

#include <cmath>

#include "closeness.h"
#include "fixture.h"
#include "mien/motion/diffusion_process.h"

namespace mien::parity {
namespace {

// "None" keeps all steps; one count is recorded as "[50]".
std::string respacing_rule(std::string text) {
  if (text == "None") return "";
  std::erase_if(text, [](char c) { return c == '[' || c == ']' || c == ' '; });
  return text;
}

void expect_recorded_arrays(const std::string& name) {
  const Fixture recorded("facediffuser", "schedule." + name + ".safetensors");
  const auto schedule = parse_beta_schedule(recorded.metadata("schedule"));
  ASSERT_TRUE(schedule);
  const DiffusionProcess whole(betas_of(*schedule, std::stoll(recorded.metadata("steps"))));
  const auto kept = respaced_steps(respacing_rule(recorded.metadata("respacing")), whole.size());
  ASSERT_TRUE(kept);
  const DiffusionProcess process = whole.respaced(*kept);
  EXPECT_EQ(*kept, recorded.integers("timestep_map"));

  const auto expect = [&](const char* array, auto&& value_at) {
    std::vector<double> values;
    for (std::int64_t i = 0; i < process.size(); ++i) values.push_back(value_at(i));
    SCOPED_TRACE(array);
    MIEN_EXPECT_CLOSE(values, recorded.doubles(array), "schedule");
  };
  const auto alpha_bar = [&](std::int64_t i) { return process.alpha_bar(i); };
  expect("betas", [&](std::int64_t i) { return process.betas()[static_cast<std::size_t>(i)]; });
  expect("alphas_cumprod", alpha_bar);
  expect("alphas_cumprod_prev", [&](std::int64_t i) { return alpha_bar(i - 1); });
  expect("alphas_cumprod_next",
         [&](std::int64_t i) { return i + 1 < process.size() ? alpha_bar(i + 1) : 0.0; });
  expect("sqrt_alphas_cumprod", [&](std::int64_t i) { return process.level(i).alpha; });
  expect("sqrt_one_minus_alphas_cumprod", [&](std::int64_t i) { return process.level(i).sigma; });
  expect("sqrt_recip_alphas_cumprod", [&](std::int64_t i) { return std::sqrt(1 / alpha_bar(i)); });
  expect("sqrt_recipm1_alphas_cumprod", [&](std::int64_t i) { return std::sqrt(1 / alpha_bar(i) - 1); });
  expect("posterior_variance", [&](std::int64_t i) { return process.posterior_variance(i); });
  expect("posterior_log_variance_clipped", [&](std::int64_t i) { return process.posterior_log_variance(i); });
  expect("posterior_mean_coef1", [&](std::int64_t i) { return process.posterior_x0_weight(i); });
  expect("posterior_mean_coef2", [&](std::int64_t i) { return process.posterior_x_weight(i); });
}

TEST(Schedule, EqualsTheRecordedArrays) {
  for_each_case("facediffuser", "schedule.", ".safetensors", expect_recorded_arrays);
}

}  // namespace
}  // namespace mien::parity
