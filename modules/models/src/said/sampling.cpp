#include "mien/models/said/sampling.h"

#include <algorithm>
#include <cmath>

#include "mien/base/contract.h"

namespace mien::said {
namespace {

// Deviation over all values of a take, divisor n - 1.
double deviation(std::span<const float> values) {
  double sum = 0, squares = 0;
  for (const float v : values) sum += v;
  const double count = static_cast<double>(values.size()), mean = sum / count;
  for (const float v : values) squares += (v - mean) * (v - mean);
  return std::sqrt(squares / (count - 1));
}

// noise: with speech -> guided.
void guide(const Guidance& guidance, std::span<const float> without, std::size_t take_size,
           std::span<float> noise) {
  for (std::size_t at = 0; at < noise.size(); at += take_size) {
    const std::span<float> own = noise.subspan(at, take_size);
    const std::span<const float> free = without.subspan(at, take_size);
    const double before = guidance.rescale > 0 ? deviation(own) : 0;
    const auto scale = static_cast<float>(guidance.scale);
    for (std::size_t i = 0; i < take_size; ++i) own[i] += scale * (own[i] - free[i]);
    if (guidance.rescale > 0) {
      const double ratio = before / deviation(own);
      const auto factor = static_cast<float>(guidance.rescale * ratio + 1 - guidance.rescale);
      for (float& v : own) v *= factor;
    }
  }
}

Status check(const SamplingOptions& options) {
  const auto wrong = [](const char* option, double value, const char* range) {
    return Error{Errc::usage, std::string(option) + " " + std::to_string(value),
                 "is not within " + std::string(range), ""};
  };
  if (!(options.strength >= 0 && options.strength <= 1))
    return wrong("--strength", options.strength, "0 ... 1");
  if (!(options.guidance.scale >= 0 && options.guidance.scale <= 100))
    return wrong("--guidance", options.guidance.scale, "0 ... 100");
  if (!(options.guidance.rescale >= 0 && options.guidance.rescale <= 1))
    return wrong("--guidance-rescale", options.guidance.rescale, "0 ... 1");
  return Done{};
}

// Thrown through the sampler, which knows no cancelling.
struct Cancelled {};

}  // namespace

Result<Tensor> sample(const NoiseNetwork& network, const DiffusionProcess& process,
                      const SamplingOptions& options, const Walk& walk, Progress& progress) {
  const auto num_takes = static_cast<std::int64_t>(walk.takes.size());
  const auto width = static_cast<std::size_t>(walk.num_channels);
  contract(num_takes >= 1 && walk.num_frames >= 1 && width >= 1, "said::sample: takes, frames and channels");
  contract(walk.known == nullptr || (walk.known->num_frames() == walk.num_frames &&
                                     walk.known->num_channels() == walk.num_channels),
           "said::sample: known values of another shape");
  MIEN_TRY([[maybe_unused]] const auto checked, check(options));
  auto steps = walked_steps(options.num_steps, process.size());
  if (!steps) return steps.error();
  Result<Tensor> result(Tensor::uninitialized({num_takes * walk.num_frames, walk.num_channels}));
  result.warnings = steps.warnings;
  Tensor& x = *result;
  const std::size_t take_size = static_cast<std::size_t>(walk.num_frames) * width;
  const auto for_each_frame = [&](std::span<float> values, const auto& use) {
    for (std::size_t l = 0; l < walk.takes.size(); ++l)
      for (std::int64_t n = 0; n < walk.num_frames; ++n)
        use(*walk.takes[l], n, values.subspan(l * take_size + static_cast<std::size_t>(n) * width, width));
  };

  std::vector<float> start_noise(x.values().size());
  for_each_frame(start_noise,
                 [](const FrameNoise& noise, std::int64_t n, std::span<float> out) { noise.start(n, out); });
  std::ranges::copy(start_noise, x.data());
  if (walk.known != nullptr) {
    const auto count =
        std::min(static_cast<std::int64_t>(static_cast<double>(options.num_steps) * options.strength),
                 options.num_steps);
    steps->erase(steps->begin(), steps->end() - count);
    const NoiseLevel first = steps->empty() ? NoiseLevel{} : process.level(steps->front());
    for_each_frame(x.values(), [&](const FrameNoise&, std::int64_t n, std::span<float> out) {
      if (walk.starts_from_noise) {
        const std::vector<float> noise(out.begin(), out.end());
        walk.known->paste(n, first, noise, out);
        return;
      }
      for (std::size_t c = 0; c < width; ++c)
        out[c] = static_cast<float>(first.alpha * walk.known->value(n, static_cast<std::int64_t>(c)) +
                                    first.sigma * static_cast<double>(out[c]));
    });
    if (steps->empty()) {
      result.warnings.emplace_back("this strength leaves no step to walk: the motion stays as it is");
      return result;
    }
  }

  const std::vector<NoiseLevel> levels = levels_of(process, *steps);
  std::vector<float> without(options.guidance.is_on() ? x.values().size() : 0);
  progress.stage("animating", static_cast<std::int64_t>(steps->size()));
  const mien::Denoiser denoise = [&](int step, NoiseLevel, std::span<const float> x_t, std::span<float> out) {
    if (progress.cancelled()) throw Cancelled{};
    network((*steps)[static_cast<std::size_t>(step)], x_t, out, without);
    if (options.guidance.is_on()) guide(options.guidance, without, take_size, out);
    if (walk.observe) walk.observe(step, x_t, out);
    progress.update(step + 1);
  };
  const StepNoise fresh = [&](int step, std::span<float> out) {
    for_each_frame(out, [&](const FrameNoise& noise, std::int64_t n, std::span<float> values) {
      noise.step(step, n, values);
    });
  };
  const StepEdit put_back = [&](int, NoiseLevel level, std::span<float> values) {
    const float* noise = start_noise.data();
    for_each_frame(values, [&](const FrameNoise&, std::int64_t n, std::span<float> out) {
      walk.known->paste(n, level, {noise, width}, out);
      noise += width;
    });
  };
  try {
    sample_diffusion(options.sampler, levels, denoise, fresh, x.values(),
                     walk.known != nullptr ? put_back : StepEdit());
  } catch (const Cancelled&) {
    return Error{Errc::cancelled, "animating", "interrupted", ""};
  }
  return result;
}

NoiseNetwork plain_network(const Network<Tensor>& network, const std::vector<Tensor>& contexts,
                           std::int64_t num_frames) {
  contract(!contexts.empty(), "said::plain_network: a context is needed");
  return [&network, &contexts, num_frames](std::int64_t step, std::span<const float> x_t,
                                           std::span<float> with, std::span<float> without) {
    const std::int64_t steps[] = {step};
    const Shape shape = {num_frames, network.sizes.num_channels};
    const auto take_size = static_cast<std::size_t>(num_frames * network.sizes.num_channels);
    for (std::size_t at = 0, take = 0; at < x_t.size(); at += take_size, ++take) {
      const Tensor& context = contexts[contexts.size() == 1 ? 0 : take];
      const Tensor x(shape, x_t.subspan(at, take_size));
      std::ranges::copy(network.denoiser(x, steps, context).values(), with.begin() + std::ptrdiff_t(at));
      if (without.empty()) continue;
      const Tensor free = network.denoiser(x, steps, network.null_context(context));
      std::ranges::copy(free.values(), without.begin() + std::ptrdiff_t(at));
    }
  };
}

}  // namespace mien::said
