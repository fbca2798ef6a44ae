#include "mien/motion/schedule.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "mien/base/contract.h"

namespace mien {

double NoiseLevel::half_log_snr() const {
  if (sigma <= 0) return std::numeric_limits<double>::infinity();
  return std::log(alpha / sigma);
}

NoiseLevel cosine_level(double t) {
  constexpr double kOffset = 0.008;
  const auto angle = [](double time) { return (time + kOffset) / (1 + kOffset) * std::numbers::pi / 2; };
  const double ratio = std::cos(angle(t)) / std::cos(angle(0));
  const double alpha_bar = ratio * ratio;
  return {std::sqrt(alpha_bar), std::sqrt(1 - alpha_bar)};
}

std::vector<NoiseLevel> cosine_grid(int num_steps, double power) {
  contract(num_steps >= 1, "cosine_grid: at least one step is needed");
  constexpr double kNoisiest = 0.998;  // at t = 1 nothing of x0 is left and ln(alpha/sigma) is infinite
  std::vector<NoiseLevel> levels;
  for (int i = 0; i < num_steps; ++i)
    levels.push_back(cosine_level(kNoisiest * (1 - std::pow(static_cast<double>(i) / num_steps, power))));
  levels.push_back({1, 0});
  return levels;
}

}  // namespace mien
