// Sampling FaceDiffuser at the published sizes: the fast paths beside the slower ways. Weights are random;
// speed does not depend on them. core_seconds: processor time of all threads for a second of animation,
// without the speech encoder; it does not depend on what else the machine does. Walks of the plain loop are
// cut short and counted for all steps (`steps`).
#include <benchmark/benchmark.h>

#include <memory>

#include "mien/base/parallel.h"
#include "mien/models/facediffuser/frame_diffusion.h"
#include "random_network.h"

namespace mien::facediffuser {
namespace {

constexpr double kSeconds = 4;

Sizes biwi() {
  return {.variant = Variant::vertices,
          .num_channels = 70110,
          .latent = 512,
          .hidden = 512,
          .num_steps = 500,
          .num_subjects = 6};
}

Sizes beat() {
  return {.variant = Variant::beat, .num_channels = 51, .latent = 256, .hidden = 256, .num_steps = 1000};
}

Sizes damm() {
  return {.variant = Variant::damm,
          .num_channels = 192,
          .latent = 512,
          .hidden = 512,
          .decoder = {.num_layers = 4},
          .num_steps = 5000};
}
constexpr std::int64_t kDammSteps = 1000;  // of its 5000 time tokens

template <class Denoiser>
struct Subject {
  Sizes sizes;
  double fps;
  std::shared_ptr<const Denoiser> network;
  std::shared_ptr<const FoldedDenoiser> folded;
  DiffusionProcess process;
  Tensor speech;
  Conditions<Tensor> given;

  Subject(const Sizes& s, double frames_a_second)
      : sizes(s),
        fps(frames_a_second),
        network(std::make_shared<const Denoiser>(random_network(Denoiser(s)))),
        folded(std::make_shared<const FoldedDenoiser>(fold(network))),
        process(betas_of(BetaSchedule::cosine, s.variant == Variant::damm ? kDammSteps : s.num_steps)),
        speech(random_rows(static_cast<std::int64_t>(kSeconds * frames_a_second), s.condition, 5)) {
    given.speech = network->speech_tokens(speech);
    if constexpr (std::is_same_v<Denoiser, VertexDenoiser<Tensor>>) {
      given.style = network->style(Operations<Tensor>::one_hot({}, 1, sizes.num_subjects));
      given.neutral = random_rows(1, sizes.num_channels, 6);
    }
  }
};

const Subject<VertexDenoiser<Tensor>>& mesh() {
  static const Subject<VertexDenoiser<Tensor>> subject(biwi(), 25);
  return subject;
}

const Subject<BeatDenoiser<Tensor>>& rig() {
  static const Subject<BeatDenoiser<Tensor>> subject(beat(), 30);
  return subject;
}

const Subject<DammDenoiser<Tensor>>& controls() {
  static const Subject<DammDenoiser<Tensor>> subject(damm(), 30);
  return subject;
}

void report(benchmark::State& state, double seconds_of_animation, std::int64_t steps, double share = 1) {
  state.counters["steps"] = static_cast<double>(steps);
  state.counters["core_seconds"] =
      benchmark::Counter(seconds_of_animation * share * static_cast<double>(state.iterations()),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

// Arguments: steps, frames in a block, takes side by side.
template <class Denoiser>
void frame_by_frame(benchmark::State& state, const Subject<Denoiser>& s) {
  const std::int64_t steps = state.range(0), block = state.range(1);
  const auto num_takes = static_cast<std::size_t>(state.range(2));
  const SeededFrameNoise noise(1, 0, s.folded->noise_width);
  const Walk walk{.skip = s.process.size() - steps};
  for (auto _ : state) {
    FrameDiffusion diffusion(
        s.folded, s.process, walk,
        std::vector<Lane>(num_takes, Lane{s.given.style, s.given.neutral, &noise, false}),
        hardware_threads());
    for (std::int64_t at = 0; at < s.speech.num_rows(); at += block) {
      const std::vector<Tensor> speech(num_takes,
                                       rows(s.speech, at, std::min(block, s.speech.num_rows() - at)));
      benchmark::DoNotOptimize(diffusion.next(speech));
    }
  }
  report(state, kSeconds * static_cast<double>(num_takes), steps);
}

// Clips of a second each, as a game has lines of dialogue. Arguments: steps, clips, clips side by side.
template <class Denoiser>
void short_clips(benchmark::State& state, const Subject<Denoiser>& s) {
  const std::int64_t steps = state.range(0), num_clips = state.range(1), together = state.range(2);
  const auto num_frames = static_cast<std::int64_t>(s.fps);
  const SeededFrameNoise noise(1, 0, s.folded->noise_width);
  const Walk walk{.skip = s.process.size() - steps};
  std::vector<Tensor> clips;
  for (std::int64_t i = 0; i < num_clips; ++i)
    clips.push_back(random_rows(num_frames, s.sizes.condition, 10 + static_cast<std::uint64_t>(i)));
  for (auto _ : state) {
    for (std::int64_t at = 0; at < num_clips; at += together) {
      const auto count = static_cast<std::size_t>(std::min(together, num_clips - at));
      FrameDiffusion diffusion(s.folded, s.process, walk,
                               std::vector<Lane>(count, Lane{s.given.style, s.given.neutral, &noise, false}),
                               hardware_threads());
      benchmark::DoNotOptimize(diffusion.next(std::span(clips).subspan(static_cast<std::size_t>(at), count)));
    }
  }
  report(state, static_cast<double>(num_clips), steps);
}

// As published, but for the speech encoder, which the authors run at every step. Argument: steps that are
// run.
template <class Denoiser>
void plainly(benchmark::State& state, const Subject<Denoiser>& s) {
  const std::int64_t run = state.range(0);
  const SeededFrameNoise noise(1, 0, s.sizes.num_channels);
  for (auto _ : state)
    benchmark::DoNotOptimize(
        sample_plainly(*s.network, s.given, s.process, {.skip = s.process.size() - run}, noise));
  report(state, kSeconds, s.process.size(), static_cast<double>(run) / static_cast<double>(s.process.size()));
}

void fold_biwi(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(fold(mesh().network, hardware_threads()));
}

void v_fast(benchmark::State& state) { frame_by_frame(state, mesh()); }
void v_plain(benchmark::State& state) { plainly(state, mesh()); }
void beat_fast(benchmark::State& state) { frame_by_frame(state, rig()); }
void beat_plain(benchmark::State& state) { plainly(state, rig()); }
void damm_fast(benchmark::State& state) { frame_by_frame(state, controls()); }
void damm_plain(benchmark::State& state) { plainly(state, controls()); }
void v_short(benchmark::State& state) { short_clips(state, mesh()); }
void beat_short(benchmark::State& state) { short_clips(state, rig()); }

constexpr auto kMs = benchmark::kMillisecond;
BENCHMARK(v_plain)->Name("face/v_biwi/plain_loop")->Arg(2)->Unit(kMs)->MeasureProcessCPUTime()->Iterations(1);
BENCHMARK(v_fast)
    ->Name("face/v_biwi/latent_wavefront")
    ->Args({500, 128, 1})
    ->Unit(kMs)
    ->MeasureProcessCPUTime();
BENCHMARK(v_fast)
    ->Name("face/v_biwi/latent_wavefront")
    ->Args({50, 128, 1})
    ->Unit(kMs)
    ->MeasureProcessCPUTime();
BENCHMARK(v_fast)
    ->Name("face/v_biwi/latent_one_frame_at_a_time")
    ->Args({50, 1, 1})
    ->Unit(kMs)
    ->MeasureProcessCPUTime();
BENCHMARK(v_fast)
    ->Name("face/v_biwi/four_takes_at_once")
    ->Args({50, 128, 4})
    ->Unit(kMs)
    ->MeasureProcessCPUTime();
BENCHMARK(fold_biwi)->Name("face/v_biwi/fold_once")->Unit(kMs)->MeasureProcessCPUTime()->Iterations(1);
BENCHMARK(beat_plain)->Name("face/b_beat/plain_loop")->Arg(20)->Unit(kMs)->MeasureProcessCPUTime();
BENCHMARK(beat_fast)->Name("face/b_beat/wavefront")->Args({1000, 128, 1})->Unit(kMs)->MeasureProcessCPUTime();
BENCHMARK(beat_fast)
    ->Name("face/b_beat/one_frame_at_a_time")
    ->Args({1000, 1, 1})
    ->Unit(kMs)
    ->MeasureProcessCPUTime();
BENCHMARK(beat_fast)
    ->Name("face/b_beat/four_takes_one_frame_at_a_time")
    ->Args({1000, 1, 4})
    ->Unit(kMs)
    ->MeasureProcessCPUTime();

BENCHMARK(damm_plain)
    ->Name("face/b_damm/plain_loop")
    ->Arg(4)
    ->Unit(kMs)
    ->MeasureProcessCPUTime()
    ->Iterations(1);
BENCHMARK(damm_fast)
    ->Name("face/b_damm/wavefront")
    ->Args({1000, 128, 1})
    ->Unit(kMs)
    ->MeasureProcessCPUTime()
    ->Iterations(1);
BENCHMARK(v_short)
    ->Name("face/v_biwi/eight_clips_of_a_second")
    ->ArgNames({"steps", "clips", "together"})
    ->Args({50, 8, 1})
    ->Args({50, 8, 4})
    ->Args({50, 8, 8})
    ->Unit(kMs)
    ->UseRealTime()
    ->MeasureProcessCPUTime();
BENCHMARK(beat_short)
    ->Name("face/b_beat/eight_clips_of_a_second")
    ->ArgNames({"steps", "clips", "together"})
    ->Args({1000, 8, 1})
    ->Args({1000, 8, 4})
    ->Args({1000, 8, 8})
    ->Unit(kMs)
    ->UseRealTime()
    ->MeasureProcessCPUTime();

}  // namespace
}  // namespace mien::facediffuser
