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

// x0 of a kept epsilon: the direction is the network's own.
SampleStep with_kept_epsilon(SampleStep step, NoiseLevel to) {
  step.epsilon = step.x * step.level.sigma;
  step.x0 = to.alpha;
  step.x = 0;
  return step;
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
                       std::span<const float> z, std::span<const float> epsilon_estimate) const {
  combine(x_t, x, estimate, x0);
  if (previous_x0 != 0) combine(x_t, 1, last, previous_x0);
  if (epsilon != 0) combine(x_t, 1, epsilon_estimate, epsilon);
  if (noise > 0) combine(x_t, 1, z, noise);
}

void to_x0(Prediction prediction, NoiseLevel level, std::span<const float> x_t, std::span<float> estimate,
           std::span<float> epsilon) {
  if (prediction == Prediction::x0 && epsilon.empty()) return;
  for (std::size_t i = 0; i < x_t.size(); ++i) {
    const double x = x_t[i], said = estimate[i];
    double x0 = said, noise = said;
    switch (prediction) {
      case Prediction::x0:
        noise = (x - level.alpha * said) / level.sigma;
        break;
      case Prediction::epsilon:
        x0 = (x - level.sigma * said) / level.alpha;
        break;
      case Prediction::velocity:
        x0 = level.alpha * x - level.sigma * said;
        noise = level.alpha * said + level.sigma * x;
        break;
    }
    estimate[i] = static_cast<float>(x0);
    if (!epsilon.empty()) epsilon[i] = static_cast<float>(noise);
  }
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
      const bool is_ancestral = options.kind == SamplerKind::ancestral;
      const SampleStep step = ddim_step(from, to, is_ancestral ? 1.0 : options.eta);
      steps.push_back(options.keeps_epsilon && !is_ancestral ? with_kept_epsilon(step, to) : step);
    }
  }
  return steps;
}

void sample_diffusion(const SamplerOptions& options, std::span<const NoiseLevel> levels,
                      const Denoiser& denoise, const StepNoise& noise, std::span<float> x,
                      const StepEdit& edit) {
  std::vector<float> x0(x.size()), last(x.size()), z(x.size());
  std::vector<float> epsilon(options.keeps_epsilon ? x.size() : 0);
  const std::vector<SampleStep> steps = plan_sampling(options, levels);
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const SampleStep& step = steps[i];
    denoise(static_cast<int>(i), step.level, x, x0);
    to_x0(options.prediction, step.level, x, x0, epsilon);
    if (options.clip_x0)
      for (float& v : x0) v = std::clamp(v, options.clip_x0->low, options.clip_x0->high);
    if (step.noise > 0) noise(static_cast<int>(i), z);
    step.apply(x, x0, last, z, epsilon);
    if (edit) edit(static_cast<int>(i), levels[i + 1], x);
    std::swap(x0, last);
  }
}

}  // namespace mien
