#pragma once
#include <functional>
#include <optional>
#include <span>
#include <string_view>

#include "mien/motion/schedule.h"

namespace mien {

/// How to walk from noise to data. All use a network that predicts x0.
enum class SamplerKind {
  ancestral,  ///< DDPM (Ho et al. 2020): fresh noise at every step
  ddim,       ///< Song et al. 2021; deterministic at eta = 0, ancestral at eta = 1
  dpmpp_2m,   ///< DPM-Solver++ (Lu et al. 2022), second order multistep, data prediction, deterministic
};
std::optional<SamplerKind> parse_sampler(std::string_view name);  ///< "ddpm", "ddim", "dpm++"

struct SamplerOptions {
  SamplerKind kind = SamplerKind::dpmpp_2m;
  double eta = 0;  ///< ddim only: share of fresh noise, 0 ... 1
};

/// Writes the network's estimate of x0 for `x_t` at levels[step] to `x0`. All spans have the size of x.
using Denoiser =
    std::function<void(int step, NoiseLevel level, std::span<const float> x_t, std::span<float> x0)>;
/// Writes standard normal noise for the step to `out`.
using StepNoise = std::function<void(int step, std::span<float> out)>;

/// Walks x from levels.front() to levels.back() in levels.size() - 1 steps. On entry x holds noise of
/// levels.front(), on return the sample; when levels.back() is clean that is the last estimate of x0. The
/// noise is an argument, so that a seed or recorded noise replays the same sample. Works on any number of
/// values at once; element i depends only on element i of the network's estimates.
void sample_diffusion(const SamplerOptions& options, std::span<const NoiseLevel> levels,
                      const Denoiser& denoise, const StepNoise& noise, std::span<float> x);

}  // namespace mien
