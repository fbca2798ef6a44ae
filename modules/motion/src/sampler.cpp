#include "mien/motion/sampler.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "mien/base/contract.h"

namespace mien {
namespace {

// x = a x + b y.
void combine(std::span<float> x, double a, std::span<const float> y, double b) {
  for (std::size_t i = 0; i < x.size(); ++i)
    x[i] = static_cast<float>(a * static_cast<double>(x[i]) + b * static_cast<double>(y[i]));
}

// DDIM (Song et al. 2021, equation 12) written in x0: x_next = alpha' x0 + sqrt(sigma'^2 - s^2) epsilon + s
// z, where epsilon = (x - alpha x0) / sigma and s = eta sigma'/sigma sqrt(1 - alpha^2/alpha'^2). eta = 1 is
// the ancestral step.
void ddim_step(std::span<float> x, std::span<const float> x0, NoiseLevel from, NoiseLevel to, double eta,
               const std::function<void(std::span<float>)>& fresh_noise, std::vector<float>& z) {
  const double ratio = from.alpha / to.alpha;
  const double s = eta * to.sigma / from.sigma * std::sqrt(std::max(0.0, 1 - ratio * ratio));
  const double direction = std::sqrt(std::max(0.0, to.sigma * to.sigma - s * s)) / from.sigma;
  combine(x, direction, x0, to.alpha - direction * from.alpha);
  if (s <= 0) return;
  fresh_noise(z);
  combine(x, 1, z, s);
}

}  // namespace

std::optional<SamplerKind> parse_sampler(std::string_view name) {
  if (name == "ddpm") return SamplerKind::ancestral;
  if (name == "ddim") return SamplerKind::ddim;
  if (name == "dpm++") return SamplerKind::dpmpp_2m;
  return std::nullopt;
}

void sample_diffusion(const SamplerOptions& options, std::span<const NoiseLevel> levels,
                      const Denoiser& denoise, const StepNoise& noise, std::span<float> x) {
  contract(levels.size() >= 2, "sample_diffusion: at least two noise levels are needed");
  const auto num_steps = static_cast<int>(levels.size()) - 1;
  std::vector<float> x0(x.size()), previous_x0(x.size()), z(x.size());
  double previous_h = 0;
  for (int step = 0; step < num_steps; ++step) {
    const NoiseLevel from = levels[step], to = levels[step + 1];
    contract(from.sigma > 0, "sample_diffusion: only the last noise level may be clean");
    denoise(step, from, x, x0);
    if (to.sigma <= 0) {
      std::copy(x0.begin(), x0.end(), x.begin());
    } else if (options.kind == SamplerKind::dpmpp_2m) {
      // Lu et al. 2022, algorithm 2: D extrapolates x0 along lambda from the last two estimates.
      const double h = to.half_log_snr() - from.half_log_snr();
      const double slope = step == 0 ? 0.0 : h / (2 * previous_h);
      const double weight = -to.alpha * std::expm1(-h);
      combine(x, to.sigma / from.sigma, x0, weight * (1 + slope));
      if (slope != 0) combine(x, 1, previous_x0, -weight * slope);
      previous_h = h;
      std::swap(x0, previous_x0);
    } else {
      const double eta = options.kind == SamplerKind::ancestral ? 1.0 : options.eta;
      ddim_step(
          x, x0, from, to, eta, [&](std::span<float> out) { noise(step, out); }, z);
    }
  }
}

}  // namespace mien
