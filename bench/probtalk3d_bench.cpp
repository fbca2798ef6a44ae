// ProbTalk3D at the published sizes: takes of one clip of 4 s, with the speech encoder. Takes share all but
// the draw and the decoder. Weights are random; speed does not depend on them. cpu: processor time of all
// threads.
#include <benchmark/benchmark.h>

#include "mien/base/parallel.h"
#include "mien/models/probtalk3d/conventions.h"
#include "mien/models/probtalk3d/takes.h"
#include "mien/models/seeds.h"
#include "mien/models/speech_encoder/encoder_runtime.h"
#include "random_encoder.h"
#include "random_network.h"

namespace mien::probtalk3d {
namespace {

constexpr double kSeconds = 4;

Sizes published(bool variational) {
  Sizes s;
  s.predictor_blocks = 12;
  s.condition = 1536;
  s.style = 43;
  if (variational) s.num_codes = s.code_width = 0;
  return s;
}

// Arguments: takes, threads.
void takes_of_a_clip(benchmark::State& state, bool variational) {
  static const EncoderRuntime encoder(random_encoder());
  const auto network = random_network(Network<Tensor>(published(variational)));
  const int num_takes = static_cast<int>(state.range(0));
  EncodeOptions options;
  options.num_threads = static_cast<int>(state.range(1));
  const Tensor style({1, 43}, style_weights(27, 32, 1, 8, 2, 3));
  const auto recording = noise_like_speech(kSeconds);
  for (auto _ : state) {
    auto samples = recording;
    stretch_waveform(samples);
    const auto features = encoder.encode(samples, options);
    if (!features) return state.SkipWithError(features.error().message().c_str());
    const Tensor pairs = group_rows(rows(*features, 0, features->num_rows() / 2 * 2), 2);
    const Takes takes(network, network.predictor(pairs, style), {});
    parallel_for(options.num_threads, num_takes, [&](std::int64_t take) {
      benchmark::DoNotOptimize(takes.take(performance_seed(1, static_cast<int>(take))));
    });
  }
  state.counters["real_time_factor"] =
      benchmark::Counter(kSeconds * static_cast<double>(state.iterations()),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

BENCHMARK_CAPTURE(takes_of_a_clip, codes, false)
    ->Name("probtalk3d/codes")
    ->ArgNames({"takes", "threads"})
    ->ArgsProduct({{1, 10}, {1, 2}})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();
BENCHMARK_CAPTURE(takes_of_a_clip, gaussian, true)
    ->Name("probtalk3d/gaussian")
    ->ArgNames({"takes", "threads"})
    ->ArgsProduct({{1, 10}, {1}})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();

}  // namespace
}  // namespace mien::probtalk3d
