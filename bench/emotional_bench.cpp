// The emotional FaceDiffuser at the published sizes: 4 s of speech to vertices by the authors' walk, the last
// 100 of 1000 steps with DDIM. Fast path, and beside it the plain loop, whole network and mesh at every step
// (counted for 100 steps from a few, as in face_bench.cpp). The authors' program runs the speech encoder at
// every step too. Weights are random; speed does not depend on them. cpu: processor time of all threads.
#include <benchmark/benchmark.h>

#include <chrono>
#include <memory>

#include "mien/models/facediffuser/frame_diffusion.h"
#include "mien/models/speech_encoder/encoder_runtime.h"
#include "random_encoder.h"
#include "random_network.h"

namespace mien::facediffuser {
namespace {

constexpr double kSeconds = 4;
constexpr std::int64_t kFrames = 99, kSteps = 1000, kSkip = 900;

struct Emotional {
  Sizes sizes{.variant = Variant::vertices,
              .num_channels = 3 * 5023,
              .latent = 256,
              .hidden = 256,
              .num_steps = kSteps,
              .num_subjects = kEmotionalStyle,
              .styles_speech = true};
  std::shared_ptr<const VertexDenoiser<Tensor>> network =
      std::make_shared<const VertexDenoiser<Tensor>>(random_network(VertexDenoiser<Tensor>(sizes)));
  std::shared_ptr<const FoldedDenoiser> folded = std::make_shared<const FoldedDenoiser>(fold(network));
  DiffusionProcess process{betas_of(BetaSchedule::cosine, kSteps)};
  Tensor style = network->style(Operations<Tensor>::one_hot({}, 1, kEmotionalStyle));
  Tensor neutral = random_rows(1, sizes.num_channels, 6);
};
const Emotional& emotional() {
  static const Emotional all;
  return all;
}

Walk published_walk() { return {.sampler = {.kind = SamplerKind::ddim}, .skip = kSkip}; }

Tensor walk_fast(const Tensor& speech, int num_threads) {
  const Emotional& e = emotional();
  const SeededFrameNoise noise(1, 0, e.folded->noise_width);
  FrameDiffusion diffusion(e.folded, e.process, published_walk(), {Lane{e.style, e.neutral, &noise, false}},
                           num_threads);
  return std::move(diffusion.next(std::span(&speech, 1)).front());
}

// Argument: threads.
void fast(benchmark::State& state) {
  const Tensor speech = random_rows(kFrames, emotional().sizes.condition, 5);
  for (auto _ : state) benchmark::DoNotOptimize(walk_fast(speech, static_cast<int>(state.range(0))));
}

// The same behind the speech encoder, as `mien animate` runs it. Argument: threads.
void with_encoder(benchmark::State& state, EncoderPrecision precision) {
  const EncoderRuntime encoder(random_encoder(), precision);
  EncodeOptions options;
  options.num_threads = static_cast<int>(state.range(0));
  auto samples = noise_like_speech(kSeconds);
  const auto animate = [&] {
    const Tensor features = encoder.encode(samples, options).value();
    return walk_fast(group_rows(rows(features, 0, 2 * kFrames), 2), static_cast<int>(state.range(0)));
  };
  benchmark::DoNotOptimize(animate());  // kernels are made once
  const auto start = std::chrono::steady_clock::now();
  for (auto _ : state) benchmark::DoNotOptimize(animate());
  state.counters["clock_seconds"] =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() /
      static_cast<double>(state.iterations());
}

// Argument: steps that are run; seconds_of_100_steps is their processor time for the whole walk.
void plain(benchmark::State& state) {
  const Emotional& e = emotional();
  const Tensor speech = random_rows(kFrames, e.sizes.condition, 5);
  const SeededFrameNoise noise(1, 0, e.sizes.num_channels);
  Walk walk = published_walk();
  walk.skip = kSteps - state.range(0);
  for (auto _ : state) {
    const Conditions<Tensor> given{e.network->speech_tokens(speech), e.style, e.neutral};
    benchmark::DoNotOptimize(sample_plainly(*e.network, given, e.process, walk, noise));
  }
  state.counters["seconds_of_100_steps"] =
      benchmark::Counter(static_cast<double>(state.range(0) * state.iterations()) / (kSteps - kSkip),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

constexpr auto kMs = benchmark::kMillisecond;
BENCHMARK(fast)
    ->Name("emotional/latent_wavefront")
    ->ArgName("threads")
    ->Arg(1)
    ->Arg(2)
    ->Unit(kMs)
    ->MeasureProcessCPUTime();
BENCHMARK(plain)
    ->Name("emotional/plain_loop")
    ->ArgName("steps")
    ->Arg(5)
    ->Unit(kMs)
    ->MeasureProcessCPUTime()
    ->Iterations(1);
const bool registered = [] {
  const std::pair<const char*, EncoderPrecision> precisions[] = {{"float32", EncoderPrecision::float32},
                                                                 {"bfloat16", EncoderPrecision::bfloat16}};
  for (const auto& [name, precision] : precisions)
    if (encoder_precision_available(precision))
      benchmark::RegisterBenchmark((std::string("emotional/with_encoder/") + name).c_str(), with_encoder,
                                   precision)
          ->ArgName("threads")
          ->Arg(1)
          ->Arg(2)
          ->Unit(kMs)
          ->MeasureProcessCPUTime();
  return true;
}();

}  // namespace
}  // namespace mien::facediffuser
