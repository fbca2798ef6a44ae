#include "mien/models/facediffuser/plain_sampler.h"

#include <algorithm>

namespace mien::facediffuser {

Tensor sample_plainly(const std::function<Tensor(const Tensor& x_t, std::int64_t network_step)>& denoise,
                      std::int64_t num_frames, std::int64_t num_channels, const DiffusionProcess& process,
                      const Walk& walk, const FrameNoise& noise, const StepObserver& observe) {
  const std::vector<NoiseLevel> levels = process.sampling_levels(walk.skip);
  Tensor x = Tensor::uninitialized({num_frames, num_channels});
  for (std::int64_t n = 0; n < num_frames; ++n) noise.start(n, x.row(n));
  // A walk that leaves out steps starts from nothing but noise at its own level (an all-zero animation,
  // noised).
  if (walk.skip > 0) x = scale(std::move(x), static_cast<float>(levels.front().sigma));
  const std::int64_t num_kept = walk.kept != nullptr ? std::min(num_frames, walk.kept->num_frames()) : 0;
  if (walk.kept != nullptr) {
    const auto alpha = static_cast<float>(levels.front().alpha);
    for (std::int64_t n = 0; n < num_kept; ++n)
      for (std::int64_t c = 0; c < num_channels; ++c)
        x.row(n)[static_cast<std::size_t>(c)] += alpha * walk.kept->weight(n, c) * walk.kept->value(n, c);
  }
  const auto last_step = static_cast<int>(levels.size()) - 2;
  const Denoiser estimate = [&](int step, NoiseLevel, std::span<const float> x_t, std::span<float> x0) {
    const Tensor state({num_frames, num_channels}, x_t);
    const Tensor result = denoise(state, process.network_step(process.size() - 1 - walk.skip - step));
    if (observe) observe(step, state, result);
    std::copy(result.values().begin(), result.values().end(), x0.begin());
    if (step == last_step) return;
    const auto width = static_cast<std::size_t>(num_channels);
    for (std::int64_t n = 0; n < num_kept; ++n)
      walk.kept->paste(n, x0.subspan(static_cast<std::size_t>(n) * width, width));
  };
  const StepNoise fresh = [&](int step, std::span<float> out) {
    const auto width = static_cast<std::size_t>(num_channels);
    for (std::int64_t n = 0; n < num_frames; ++n)
      noise.step(step, n, out.subspan(static_cast<std::size_t>(n) * width, width));
  };
  sample_diffusion(walk.sampler, levels, estimate, fresh, x.values());
  return x;
}

}  // namespace mien::facediffuser
