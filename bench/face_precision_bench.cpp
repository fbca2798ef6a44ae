// What a coarser speech encoder does to the motion: FaceDiffuser at the published sizes with random weights,
// 4 s of speech, 50 steps with the same seed, once with the encoder in float32 and once in fewer bits.
// lve_percent: largest distance of a vertex in a frame (of a channel, for B-BEAT), mean over frames; percent
// of the motion's range, which is the longest way of a vertex (channel) between its extremes.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "mien/base/parallel.h"
#include "mien/models/alignment.h"
#include "mien/models/facediffuser/frame_diffusion.h"
#include "mien/models/speech_encoder/encoder_runtime.h"
#include "mien/motion/diffusion_process.h"
#include "random_encoder.h"
#include "random_network.h"

namespace mien::facediffuser {
namespace {

constexpr double kSeconds = 4;

Tensor hidden_states(EncoderPrecision precision) {
  EncodeOptions options;
  options.num_threads = hardware_threads();
  auto hidden = EncoderRuntime(random_encoder(), precision).encode(noise_like_speech(kSeconds), options);
  if (!hidden) throw std::runtime_error(hidden.error().message());
  return std::move(*hidden);
}

// The same walk for any speech.
template <class Denoiser>
Tensor performed(const std::shared_ptr<const FoldedDenoiser>& folded, const Denoiser& network, double fps,
                 const Tensor& hidden) {
  const std::int64_t num_frames = num_diffuser_frames(static_cast<std::int64_t>(kSeconds * 16000), fps);
  const Tensor speech = aligned(hidden, align_features(hidden.num_rows(), num_frames, fps));
  const DiffusionProcess whole(betas_of(BetaSchedule::cosine, network.sizes.num_steps));
  const DiffusionProcess process = whole.respaced(*respaced_steps("50", whole.size()));
  const SeededFrameNoise noise(1, 0, folded->noise_width);
  Lane lane{{}, {}, &noise, false};
  if constexpr (std::is_same_v<Denoiser, VertexDenoiser<Tensor>>) {
    lane.style = network.style(Operations<Tensor>::one_hot({}, 1, network.sizes.num_subjects));
    lane.neutral = Tensor({1, network.sizes.num_channels});
  }
  FrameDiffusion diffusion(folded, process, {}, {lane}, hardware_threads());
  return diffusion.next(std::vector<Tensor>{speech}).front();
}

// @param width  numbers that move together: 3 for vertices, 1 for channels
void report(benchmark::State& state, const Tensor& exact, const Tensor& coarse, std::int64_t width) {
  double range = 0, sum = 0;
  for (std::int64_t c = 0; c < exact.width(); c += width) {
    double way = 0;
    for (std::int64_t i = c; i < c + width; ++i) {
      float least = exact.data()[i], most = least;
      for (std::int64_t n = 0; n < exact.num_rows(); ++n) {
        least = std::min(least, exact.data()[n * exact.width() + i]);
        most = std::max(most, exact.data()[n * exact.width() + i]);
      }
      way += static_cast<double>(most - least) * (most - least);
    }
    range = std::max(range, std::sqrt(way));
  }
  for (std::int64_t n = 0; n < exact.num_rows(); ++n) {
    double farthest = 0;
    for (std::int64_t c = 0; c < exact.width(); c += width) {
      double squares = 0;
      for (std::int64_t i = n * exact.width() + c; i < n * exact.width() + c + width; ++i) {
        const double d = static_cast<double>(coarse.data()[i]) - exact.data()[i];
        squares += d * d;
      }
      farthest = std::max(farthest, std::sqrt(squares));
    }
    sum += farthest;
  }
  state.counters["lve_percent"] = 100 * sum / static_cast<double>(exact.num_rows()) / range;
  state.counters["range"] = range;
}

template <class Denoiser>
void compare(benchmark::State& state, const Sizes& sizes, double fps, EncoderPrecision precision) {
  const auto network = std::make_shared<const Denoiser>(random_network(Denoiser(sizes)));
  const auto folded = std::make_shared<const FoldedDenoiser>(fold(network));
  const Tensor exact = performed(folded, *network, fps, hidden_states(EncoderPrecision::float32));
  Tensor coarse;
  for (auto _ : state) coarse = performed(folded, *network, fps, hidden_states(precision));
  report(state, exact, coarse, sizes.variant == Variant::vertices ? 3 : 1);
}

const bool registered = [] {
  const Sizes biwi{.variant = Variant::vertices,
                   .num_channels = 70110,
                   .latent = 512,
                   .hidden = 512,
                   .num_steps = 500,
                   .num_subjects = 6};
  const Sizes beat{
      .variant = Variant::beat, .num_channels = 51, .latent = 256, .hidden = 256, .num_steps = 1000};
  for (const auto& [name, precision] :
       {std::pair("bfloat16", EncoderPrecision::bfloat16), std::pair("int8", EncoderPrecision::int8)}) {
    if (!encoder_precision_available(precision)) continue;
    benchmark::RegisterBenchmark(("face/v_biwi/encoder_precision/" + std::string(name)).c_str(),
                                 compare<VertexDenoiser<Tensor>>, biwi, 25.0, precision)
        ->Iterations(1)
        ->Unit(benchmark::kMillisecond);
    benchmark::RegisterBenchmark(("face/b_beat/encoder_precision/" + std::string(name)).c_str(),
                                 compare<BeatDenoiser<Tensor>>, beat, 30.0, precision)
        ->Iterations(1)
        ->Unit(benchmark::kMillisecond);
  }
  return true;
}();

}  // namespace
}  // namespace mien::facediffuser
