#pragma once
#include <cstdint>
#include <string_view>
#include <vector>

#include "mien/base/result.h"
#include "mien/motion/diffusion_process.h"
#include "mien/motion/sampler.h"

namespace mien::said {

/// The process that the denoiser was trained with: a schedule of T steps in the float32 of the diffusers
/// library. @pre num_steps >= 1
DiffusionProcess training_process(BetaSchedule schedule = BetaSchedule::cosine,
                                  std::int64_t num_steps = 1000);

/// Step numbers of a walk of `num_steps` through T: (n - 1) r, ..., 2 r, r, 0 with r = floor(T / n). Warning:
/// n above T / 2 but not T begins far below the noisiest level, T - 1. Error (Errc::usage): not 1 ... T
/// steps.
Result<std::vector<std::int64_t>> walked_steps(std::int64_t num_steps, std::int64_t trained_steps);

/// The levels of those steps, and clean.
std::vector<NoiseLevel> levels_of(const DiffusionProcess& process, const std::vector<std::int64_t>& steps);

/// SAiD's own sampler: DDIM on the predicted noise, estimates of x0 clipped to -1 ... 1.
[[nodiscard]] inline SamplerOptions published_sampler() {
  SamplerOptions options{.kind = SamplerKind::ddim};
  options.clip_x0 = {.low = -1, .high = 1};
  options.prediction = Prediction::epsilon;
  options.keeps_epsilon = true;
  return options;
}

}  // namespace mien::said
