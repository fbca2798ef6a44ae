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
// the ancestral step with the posterior's own variance.
SampleStep ddim_step(NoiseLevel from, NoiseLevel to, double eta) {
  const double ratio = from.alpha / to.alpha;
  const double s = eta * to.sigma / from.sigma * std::sqrt(std::max(0.0, 1 - ratio * ratio));
  const double direction = std::sqrt(std::max(0.0, to.sigma * to.sigma - s * s)) / from.sigma;
  return {.level = from, .x = direction, .x0 = to.alpha - direction * from.alpha, .noise = std::max(s, 0.0)};
}

}  // namespace

std::optional<SamplerKind> parse_sampler(std::string_view name) {
  if (name == "ddpm") return SamplerKind::ancestral;
  if (name == "ddim") return SamplerKind::ddim;
  if (name == "dpm++") return SamplerKind::dpmpp_2m;
  return std::nullopt;
}

void SampleStep::apply(std::span<float> x_t, std::span<const float> estimate, std::span<const float> last,
                       std::span<const float> z) const {
  combine(x_t, x, estimate, x0);
  if (previous_x0 != 0) combine(x_t, 1, last, previous_x0);
  if (noise > 0) combine(x_t, 1, z, noise);
}

std::vector<SampleStep> plan_sampling(const SamplerOptions& options, std::span<const NoiseLevel> levels) {
  contract(levels.size() >= 2, "plan_sampling: at least two noise levels are needed");
  std::vector<SampleStep> steps;
  double previous_h = 0;
  for (std::size_t i = 0; i + 1 < levels.size(); ++i) {
    const NoiseLevel from = levels[i], to = levels[i + 1];
    contract(from.sigma > 0, "plan_sampling: only the last noise level may be clean");
    if (to.sigma <= 0) {
      steps.push_back({.level = from});
    } else if (options.kind == SamplerKind::dpmpp_2m) {
      // Lu et al. 2022, algorithm 2: D extrapolates x0 along lambda from the last two estimates.
      const double h = to.half_log_snr() - from.half_log_snr();
      const double slope = i == 0 ? 0.0 : h / (2 * previous_h);
      const double weight = -to.alpha * std::expm1(-h);
      steps.push_back({.level = from,
                       .x = to.sigma / from.sigma,
                       .x0 = weight * (1 + slope),
                       .previous_x0 = -weight * slope});
      previous_h = h;
    } else {
      steps.push_back(ddim_step(from, to, options.kind == SamplerKind::ancestral ? 1.0 : options.eta));
    }
  }
  return steps;
}

void sample_diffusion(const SamplerOptions& options, std::span<const NoiseLevel> levels,
                      const Denoiser& denoise, const StepNoise& noise, std::span<float> x) {
  std::vector<float> x0(x.size()), last(x.size()), z(x.size());
  const std::vector<SampleStep> steps = plan_sampling(options, levels);
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const SampleStep& step = steps[i];
    denoise(static_cast<int>(i), step.level, x, x0);
    if (options.clip_x0)
      for (float& v : x0) v = std::clamp(v, options.clip_x0->low, options.clip_x0->high);
    if (step.noise > 0) noise(static_cast<int>(i), z);
    step.apply(x, x0, last, z);
    std::swap(x0, last);
  }
}

}  // namespace mien
