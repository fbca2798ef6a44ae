#pragma once
#include <vector>

namespace mien {

/// One point of a diffusion process: x_t = alpha x0 + sigma epsilon, with alpha^2 + sigma^2 = 1.
/// alpha = sqrt(alpha_bar).
struct NoiseLevel {
  double alpha = 1, sigma = 0;

  /// ln(alpha / sigma): half the logarithm of the signal-to-noise ratio. Infinite at sigma = 0.
  [[nodiscard]] double half_log_snr() const;
};

/// The cosine schedule in continuous time t in [0, 1] (Nichol and Dhariwal 2021, equation 17), normalised so
/// that t = 0 is clean: alpha_bar = (cos(((t + s)/(1 + s)) pi/2) / cos((s/(1 + s)) pi/2))^2 with s = 0.008.
NoiseLevel cosine_level(double t);

/// Sampling grid of the cosine schedule, from noisy to clean: t_i = 0.998 (1 - (i / num_steps)^power), i = 0
/// ... num_steps; the last level is clean. power > 1 is dense at the noisy end, where rare events are
/// decided.
/// @pre num_steps >= 1
std::vector<NoiseLevel> cosine_grid(int num_steps, double power);

}  // namespace mien
