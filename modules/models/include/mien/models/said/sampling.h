#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "mien/base/progress.h"
#include "mien/base/result.h"
#include "mien/models/said/network.h"
#include "mien/models/said/schedule.h"
#include "mien/motion/frame_noise.h"
#include "mien/motion/kept_values.h"
#include "mien/nn/runtime_operations.h"

namespace mien::said {

/// Classifier-free guidance: noise = with + scale (with - without) speech, so that what papers call the
/// weight is 1 + scale. At or below 1 there is none, as in the published program, whatever the paper says.
struct Guidance {
  double scale = 2;
  /// Share of the result that gets back the deviation of the estimate with speech (over frames and channels).
  double rescale = 0;

  [[nodiscard]] bool is_on() const { return scale > 1; }
};

struct SamplingOptions {
  SamplerOptions sampler = published_sampler();
  std::int64_t num_steps = 1000;
  Guidance guidance;
  /// Share of the steps to walk from given values: trunc(num_steps strength), the last of the walk. 0 ... 1
  double strength = 1;
};

/// What a denoiser says about takes side by side: the noise in x_t [L, N, K] at a step of the training, with
/// speech, and without where `without` is not empty (then as large).
using NoiseNetwork = std::function<void(std::int64_t network_step, std::span<const float> x_t,
                                        std::span<float> with, std::span<float> without)>;

/// Sees every step: the state before it and the guided estimate of the noise, both [L, N, K].
using StepObserver = std::function<void(int step, std::span<const float> x_t, std::span<const float> noise)>;

/// What a walk is made of beside the network.
struct Walk {
  std::int64_t num_frames = 0, num_channels = 0;  ///< N, K
  std::vector<const FrameNoise*> takes{};         ///< L of them: start noise and fresh noise of the steps
  /// Values to start from instead of noise, and which of them to keep: the walk begins with them noised to
  /// its first level, and puts the known ones back after every step with the same noise (the paper's Eq. 10).
  /// Null: from noise. @pre [N, K]
  const KeptValues* known = nullptr;
  /// With known values: the walk begins with noise where none is kept, as it would without them. For windows
  /// of a longer motion, whose known values are those of the window before.
  bool starts_from_noise = false;
  StepObserver observe{};
};

/// Reverse diffusion of all takes, [L N, K], not yet clamped to 0 ... 1. Reports steps as the work of a
/// stage. Warnings: see walked_steps(); a strength that leaves no step gives the known values back. Errors
/// (Errc::usage): steps, strength or guidance out of range; (Errc::cancelled).
Result<Tensor> sample(const NoiseNetwork& network, const DiffusionProcess& process,
                      const SamplingOptions& options, const Walk& walk, Progress& progress);

/// The whole network for every take and branch at every step: the measure of the fast paths.
/// @param contexts  one [T, D] for all takes, or one for each. Borrowed, like the network
NoiseNetwork plain_network(const Network<Tensor>& network, const std::vector<Tensor>& contexts,
                           std::int64_t num_frames);

}  // namespace mien::said
