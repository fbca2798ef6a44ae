// SAiD's denoiser at the published size: a guided step of 4 s (240 frames), the packed denoiser beside the plain
// network. Weights are random; speed does not depend on them. Real time needs an idle machine; with `cpu` it is
// the processor time of all threads.
#include <benchmark/benchmark.h>

#include "mien/models/said/fast_denoiser.h"
#include "random_network.h"

namespace mien::said {
namespace {

constexpr std::int64_t kFrames = 240, kSteps = 1000;

Backend backend_of_argument(std::int64_t index) {
  constexpr Backend kAll[] = {Backend::rowwise, Backend::onednn_bf16, Backend::onednn_int8};
  return kAll[index];
}

struct Inputs {
  Tensor x, context, with, without;
  explicit Inputs(std::int64_t takes)
      : x(random_rows(takes * kFrames, 32, 1)),
        context(random_rows(kFrames, 768, 2)),
        with(x.shape()),
        without(x.shape()) {}
};

void plain(benchmark::State& state) {
  static const auto network = random_network(Network<Tensor>(Sizes{}));
  Inputs in(1);
  const std::vector<Tensor> contexts = {in.context};
  const auto estimate = plain_network(network, contexts, kFrames);
  for (auto _ : state) estimate(500, in.x.values(), in.with.values(), in.without.values());
}

// Arguments: precision (f32, bf16, int8), threads, takes.
void packed(benchmark::State& state) {
  const Backend backend = backend_of_argument(state.range(0));
  if (!backend_available(backend)) return state.SkipWithError("this processor cannot");
  static const auto weights = random_network(Network<PlainWeights>(Sizes{}));
  const FastDenoiser denoiser(weights, kSteps, backend);
  Inputs in(state.range(2));
  const std::vector<FastDenoiser::Speech> speech = {denoiser.listen(in.context, kFrames)};
  const auto estimate = denoiser.network(speech, static_cast<int>(state.range(1)));
  for (auto _ : state) estimate(500, in.x.values(), in.with.values(), in.without.values());
}

void pack(benchmark::State& state) {
  static const auto weights = random_network(Network<PlainWeights>(Sizes{}));
  for (auto _ : state) benchmark::DoNotOptimize(FastDenoiser(weights, kSteps));
}

constexpr auto kMs = benchmark::kMillisecond;
BENCHMARK(plain)->Name("said/guided_step/plain")->Unit(kMs)->MeasureProcessCPUTime()->UseRealTime();
BENCHMARK(packed)
    ->Name("said/guided_step/packed")
    ->ArgNames({"precision", "threads", "takes"})
    ->ArgsProduct({{0, 1, 2}, {1, 2}, {1}})
    ->Args({0, 2, 4})
    ->Unit(kMs)
    ->MeasureProcessCPUTime()
    ->UseRealTime();
BENCHMARK(pack)->Name("said/pack_once")->Unit(kMs)->MeasureProcessCPUTime()->UseRealTime()->Iterations(1);

}  // namespace
}  // namespace mien::said
