#include "mien/motion/diffusion_process.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mien/base/contract.h"

namespace mien {

std::optional<BetaSchedule> parse_beta_schedule(std::string_view name) {
  if (name == "cosine") return BetaSchedule::cosine;
  if (name == "linear") return BetaSchedule::linear;
  return std::nullopt;
}

std::string_view beta_schedule_name(BetaSchedule schedule) {
  return schedule == BetaSchedule::cosine ? "cosine" : "linear";
}

std::vector<double> betas_of(BetaSchedule schedule, std::int64_t num_steps) {
  contract(num_steps >= 1, "betas_of: at least one step is needed");
  const auto count = static_cast<double>(num_steps);
  std::vector<double> betas;
  for (std::int64_t i = 0; i < num_steps; ++i) {
    const auto at = static_cast<double>(i);
    if (schedule == BetaSchedule::cosine) {
      constexpr double kLargest = 0.999;
      const auto level = [](double t) {
        const double c = std::cos((t + 0.008) / 1.008 * std::numbers::pi / 2);
        return c * c;
      };
      betas.push_back(std::min(1 - level((at + 1) / count) / level(at / count), kLargest));
    } else {
      const double first = 1000 / count * 1e-4, last = 1000 / count * 0.02;
      betas.push_back(num_steps == 1 ? first : first + (last - first) * (at / (count - 1)));
    }
  }
  return betas;
}

DiffusionProcess::DiffusionProcess(std::vector<double> betas) : betas_(std::move(betas)) {
  contract(!betas_.empty(), "DiffusionProcess: at least one beta is needed");
  double alpha_bar = 1;
  for (const double beta : betas_) {
    contract(beta > 0 && beta < 1, "DiffusionProcess: betas must lie between 0 and 1");
    alpha_bars_.push_back(alpha_bar *= 1 - beta);
    network_steps_.push_back(num_network_steps_++);
  }
}

DiffusionProcess DiffusionProcess::in_float32(std::span<const double> betas) {
  std::vector<double> rounded;
  for (const double beta : betas) {
    const float alpha = 1.0f - static_cast<float>(beta);
    rounded.push_back(1 - static_cast<double>(alpha));  // exact
  }
  DiffusionProcess out(std::move(rounded));
  for (double& alpha_bar : out.alpha_bars_) alpha_bar = static_cast<double>(static_cast<float>(alpha_bar));
  return out;
}

DiffusionProcess DiffusionProcess::respaced(std::span<const std::int64_t> kept) const {
  std::vector<double> betas;
  std::vector<std::int64_t> network_steps;
  std::int64_t previous = -1;
  for (const std::int64_t i : kept) {
    contract(i > previous && i < size(), "DiffusionProcess::respaced: steps must rise and exist");
    betas.push_back(1 - alpha_bar(i) / alpha_bar(previous));
    network_steps.push_back(network_step(i));
    previous = i;
  }
  DiffusionProcess out(std::move(betas));
  out.network_steps_ = std::move(network_steps);
  out.num_network_steps_ = num_network_steps_;
  return out;
}

double DiffusionProcess::alpha_bar(std::int64_t i) const {
  return i < 0 ? 1.0 : alpha_bars_[static_cast<std::size_t>(i)];
}

NoiseLevel DiffusionProcess::level(std::int64_t i) const {
  return {std::sqrt(alpha_bar(i)), std::sqrt(1 - alpha_bar(i))};
}

double DiffusionProcess::posterior_x0_weight(std::int64_t i) const {
  return betas_[static_cast<std::size_t>(i)] * std::sqrt(alpha_bar(i - 1)) / (1 - alpha_bar(i));
}

double DiffusionProcess::posterior_x_weight(std::int64_t i) const {
  return (1 - alpha_bar(i - 1)) * std::sqrt(1 - betas_[static_cast<std::size_t>(i)]) / (1 - alpha_bar(i));
}

double DiffusionProcess::posterior_variance(std::int64_t i) const {
  return betas_[static_cast<std::size_t>(i)] * (1 - alpha_bar(i - 1)) / (1 - alpha_bar(i));
}

double DiffusionProcess::posterior_log_variance(std::int64_t i) const {
  return std::log(posterior_variance(i == 0 && size() > 1 ? 1 : i));
}

std::vector<NoiseLevel> DiffusionProcess::sampling_levels(std::int64_t skip) const {
  contract(skip >= 0 && skip < size(), "sampling_levels: at least one step must be left");
  std::vector<NoiseLevel> levels;
  for (std::int64_t i = size() - 1 - skip; i >= -1; --i) levels.push_back(level(i));
  return levels;
}

}  // namespace mien
