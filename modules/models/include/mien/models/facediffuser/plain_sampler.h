#pragma once
#include <functional>

#include "mien/models/facediffuser/network.h"
#include "mien/motion/diffusion_process.h"
#include "mien/motion/frame_noise.h"
#include "mien/motion/kept_values.h"
#include "mien/motion/sampler.h"
#include "mien/nn/runtime_operations.h"

namespace mien::facediffuser {

/// How to walk through a diffusion process.
struct Walk {
  SamplerOptions sampler{.kind = SamplerKind::ancestral};
  std::int64_t skip = 0;  ///< noisiest steps left out, 0 ... process.size() - 1
  /// What an edit keeps, [N, D], or null; outlives the walk. Every estimate but the last has the known
  /// values, and the start has them noised to its level; so a sampler that draws no noise carries them as
  /// alpha u + sigma z with the z of the start (SAiD, section 6), and one that does as samples of the
  /// posterior given u. The last estimate is the network's own, for join_kept().
  const KeptValues* kept = nullptr;
};

/// Sees every step of a sampler: the state before it and the network's estimate.
using StepObserver = std::function<void(int step, const Tensor& x_t, const Tensor& x0)>;

/// Reverse diffusion as the papers write it: every step runs the whole network on the whole animation. The
/// measure of the fast paths; slow at the size of a mesh.
/// @param denoise  (x_t [N, D], step number of the network) -> x0 [N, D]
/// @return         [N, D]
Tensor sample_plainly(const std::function<Tensor(const Tensor& x_t, std::int64_t network_step)>& denoise,
                      std::int64_t num_frames, std::int64_t num_channels, const DiffusionProcess& process,
                      const Walk& walk, const FrameNoise& noise, const StepObserver& observe = nullptr);

/// The same with a denoiser and its conditions.
template <class Denoiser>
Tensor sample_plainly(const Denoiser& network, const Conditions<Tensor>& given,
                      const DiffusionProcess& process, const Walk& walk, const FrameNoise& noise,
                      const StepObserver& observe = nullptr) {
  return sample_plainly(
      [&](const Tensor& x_t, std::int64_t step) { return network.predict_x0(x_t, given, step); },
      given.speech.num_rows(), network.sizes.num_channels, process, walk, noise, observe);
}

}  // namespace mien::facediffuser
