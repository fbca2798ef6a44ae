#include "mien/models/said/schedule.h"

#include <string>

namespace mien::said {

DiffusionProcess training_process(BetaSchedule schedule, std::int64_t num_steps) {
  return DiffusionProcess::in_float32(betas_of(schedule, num_steps));
}

Result<std::vector<std::int64_t>> walked_steps(std::int64_t num_steps, std::int64_t trained_steps) {
  if (num_steps < 1 || num_steps > trained_steps)
    return Error{Errc::usage, "--steps " + std::to_string(num_steps),
                 "is not within 1 ... " + std::to_string(trained_steps) + ", the steps of the training", ""};
  const std::int64_t stride = trained_steps / num_steps;
  std::vector<std::int64_t> steps;
  for (std::int64_t i = num_steps - 1; i >= 0; --i) steps.push_back(i * stride);
  Result<std::vector<std::int64_t>> result(std::move(steps));
  if (stride == 1 && num_steps != trained_steps)
    result.warnings.push_back(
        std::to_string(num_steps) + " steps walk from step " + std::to_string(num_steps - 1) +
        " instead of " + std::to_string(trained_steps - 1) +
        ", so the start holds less noise than it should: take " + std::to_string(trained_steps / 2) +
        " or fewer, or all " + std::to_string(trained_steps));
  return result;
}

std::vector<NoiseLevel> levels_of(const DiffusionProcess& process, const std::vector<std::int64_t>& steps) {
  std::vector<NoiseLevel> levels;
  for (const std::int64_t step : steps) levels.push_back(process.level(step));
  levels.push_back({});
  return levels;
}

}  // namespace mien::said
