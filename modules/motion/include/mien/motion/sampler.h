#pragma once
#include <functional>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "mien/motion/schedule.h"

namespace mien {

/// How to walk from noise to data.
enum class SamplerKind {
  ancestral,  ///< DDPM (Ho et al. 2020): fresh noise at every step
  ddim,       ///< Song et al. 2021; deterministic at eta = 0, ancestral at eta = 1
  dpmpp_2m,   ///< DPM-Solver++ (Lu et al. 2022), second order multistep, data prediction, deterministic
};
std::optional<SamplerKind> parse_sampler(std::string_view name);  ///< "ddpm", "ddim", "dpm++"

/// What a network says about x_t = alpha x0 + sigma epsilon. All samplers work from x0, which each of them
/// tells.
enum class Prediction {
  x0,
  epsilon,   ///< the noise
  velocity,  ///< alpha epsilon - sigma x0 (Salimans and Ho 2022)
};

struct SamplerOptions {
  SamplerKind kind = SamplerKind::dpmpp_2m;
  double eta = 0;  ///< ddim only: share of fresh noise, 0 ... 1
  /// Bounds that every estimate of x0 is held to before it is used.
  struct Range {
    float low, high;
  };
  std::optional<Range> clip_x0{};
  Prediction prediction = Prediction::x0;
  /// ddim only: the noise that a step goes on with is what the network's own estimate says, also where x0 was
  /// clipped (the diffusers library); else it follows from the clipped x0 (Dhariwal and Nichol's library).
  bool keeps_epsilon = false;
};

/// One step of a sampler as arithmetic: x_next = x * x_t + x0 * estimate + previous_x0 * last estimate
/// + epsilon * noise estimate + noise * z. Everything a sampler is, so that other orders of work (frame by
/// frame, along a wavefront, in another linear space) do the same.
struct SampleStep {
  NoiseLevel level;  ///< of x_t
  double x = 0, x0 = 1, previous_x0 = 0;
  double epsilon = 0;  ///< 0 unless keeps_epsilon
  double noise = 0;    ///< 0: no z is drawn

  /// `x` becomes x_next. Rounds to float32 after each addition. What has the factor 0 may be empty.
  void apply(std::span<float> x_t, std::span<const float> estimate, std::span<const float> last,
             std::span<const float> z, std::span<const float> epsilon_estimate = {}) const;
};

/// A network's prediction for x_t as an estimate of x0, in place. `epsilon`: empty, or takes the noise that
/// the prediction tells.
void to_x0(Prediction prediction, NoiseLevel level, std::span<const float> x_t, std::span<float> estimate,
           std::span<float> epsilon = {});

/// The steps from levels.front() to levels.back(): levels.size() - 1 of them.
/// @pre at least two levels; only the last may be clean
std::vector<SampleStep> plan_sampling(const SamplerOptions& options, std::span<const NoiseLevel> levels);

/// Writes what the network predicts for `x_t` at levels[step] (SamplerOptions::prediction). All spans have
/// the size of x.
using Denoiser =
    std::function<void(int step, NoiseLevel level, std::span<const float> x_t, std::span<float> prediction)>;
/// Writes standard normal noise for the step to `out`.
using StepNoise = std::function<void(int step, std::span<float> out)>;
/// Changes x after the step, when it has reached `level`: known values are put back here (KeptValues::paste).
using StepEdit = std::function<void(int step, NoiseLevel level, std::span<float> x)>;

/// Walks x from levels.front() to levels.back() in levels.size() - 1 steps. On entry x holds noise of
/// levels.front(), on return the sample; when levels.back() is clean that is the last estimate of x0. The
/// noise is an argument, so that a seed or recorded noise replays the same sample. Works on any number of
/// values at once; element i depends only on element i of the network's estimates.
void sample_diffusion(const SamplerOptions& options, std::span<const NoiseLevel> levels,
                      const Denoiser& denoise, const StepNoise& noise, std::span<float> x,
                      const StepEdit& edit = nullptr);

}  // namespace mien
