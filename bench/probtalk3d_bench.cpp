// ProbTalk3D at the published sizes: takes of one clip of 4 s, with the speech encoder. Takes share all but
// the draw and the decoder. Weights are random; speed does not depend on them. cpu: processor time of all
// threads.
#include <benchmark/benchmark.h>

#include <array>
#include <chrono>
#include <memory>

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

Tensor pairs_of(const Tensor& features) {
  return group_rows(rows(features, 0, features.num_rows() / 2 * 2), 2);
}

const EncoderRuntime& encoder_of(EncoderPrecision precision) {
  static std::array<std::unique_ptr<EncoderRuntime>, 3> encoders;
  auto& slot = encoders[static_cast<std::size_t>(precision)];
  if (!slot) slot = std::make_unique<EncoderRuntime>(random_encoder(), precision);
  return *slot;
}

// From samples to parameters, one take, after a first one, the encoder's numbers as said: what `mien animate
// --precision` does. real_time_factor is of processor time, clock_real_time_factor of the clock. Argument:
// threads.
void clip(benchmark::State& state, EncoderPrecision precision) {
  const EncoderRuntime& encoder = encoder_of(precision);
  static const auto network = random_network(Network<Tensor>(published(false)));
  EncodeOptions options;
  options.num_threads = static_cast<int>(state.range(0));
  const Tensor style({1, 43}, style_weights(27, 32, 1, 8, 2, 3));
  const auto recording = noise_like_speech(kSeconds);
  const auto animate = [&] {
    auto samples = recording;
    stretch_waveform(samples);
    const auto features = encoder.encode(samples, options).value();
    const Takes takes(network, network.predictor(pairs_of(features), style), {});
    return takes.take(performance_seed(1, 0));
  };
  benchmark::DoNotOptimize(animate());  // kernels are made once
  const auto start = std::chrono::steady_clock::now();
  for (auto _ : state) benchmark::DoNotOptimize(animate());
  const double clock = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const double seconds = kSeconds * static_cast<double>(state.iterations());
  state.counters["real_time_factor"] =
      benchmark::Counter(seconds, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  state.counters["clock_real_time_factor"] = clock / seconds;
}

// What comes after the encoder alone.
void after_the_encoder(benchmark::State& state) {
  static const auto network = random_network(Network<Tensor>(published(false)));
  const Tensor style({1, 43}, style_weights(27, 32, 1, 8, 2, 3));
  const Tensor pairs = random_rows(99, 1536, 5);
  for (auto _ : state) {
    const Takes takes(network, network.predictor(pairs, style), {});
    benchmark::DoNotOptimize(takes.take(performance_seed(1, 0)));
  }
  state.counters["real_time_factor"] =
      benchmark::Counter(kSeconds * static_cast<double>(state.iterations()),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

// Arguments: takes, threads.
void takes_of_a_clip(benchmark::State& state, bool variational) {
  const EncoderRuntime& encoder = encoder_of(EncoderPrecision::float32);
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
    const Takes takes(network, network.predictor(pairs_of(*features), style), {});
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
const bool registered = [] {
  const std::pair<const char*, EncoderPrecision> precisions[] = {{"float32", EncoderPrecision::float32},
                                                                 {"bfloat16", EncoderPrecision::bfloat16},
                                                                 {"int8", EncoderPrecision::int8}};
  for (const auto& [name, precision] : precisions)
    if (encoder_precision_available(precision))
      benchmark::RegisterBenchmark((std::string("probtalk3d/clip/") + name).c_str(), clip, precision)
          ->ArgName("threads")
          ->Arg(1)
          ->Arg(2)
          ->Unit(benchmark::kMillisecond)
          ->MeasureProcessCPUTime();
  return true;
}();
BENCHMARK(after_the_encoder)
    ->Name("probtalk3d/after_the_encoder")
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
