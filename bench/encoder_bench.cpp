// Speed of the speech encoder at the size of HuBERT-base: ten seconds of sound to hidden states. Weights are
// random, scaled as in training; speed does not depend on them. Each precision reports its error against
// float32. encoder_torch_bench.cpp is the same on LibTorch.
#include <benchmark/benchmark.h>

#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "mien/models/speech_encoder/encoder_runtime.h"
#include "mien/nn/runtime_operations.h"
#include "random_encoder.h"

namespace mien {
namespace {

constexpr double kSeconds = 10;

const EncoderRuntime& encoder(EncoderPrecision precision) {
  static std::array<std::unique_ptr<EncoderRuntime>, 3> encoders;
  auto& slot = encoders[static_cast<std::size_t>(precision)];
  if (!slot) {
    slot = std::make_unique<EncoderRuntime>(random_encoder(), precision);
  }
  return *slot;
}

Tensor encoded(EncoderPrecision precision, std::span<const float> samples, const EncodeOptions& options) {
  auto result = encoder(precision).encode(samples, options);
  if (!result) throw std::runtime_error(result.error().message());
  return std::move(*result);
}

/// Root of the mean squared difference, over the root of the mean square.
double relative_error(const Tensor& got, const Tensor& want) {
  double difference = 0, size = 0;
  for (std::size_t i = 0; i < want.values().size(); ++i) {
    const double d = static_cast<double>(got.values()[i]) - want.values()[i];
    difference += d * d;
    size += static_cast<double>(want.values()[i]) * want.values()[i];
  }
  return std::sqrt(difference / size);
}

void encode(benchmark::State& state, EncoderPrecision precision, int num_threads) {
  const auto samples = noise_like_speech(kSeconds);
  EncodeOptions options;
  options.num_threads = num_threads;
  Tensor last = encoded(precision, samples, options);
  for (auto _ : state) last = encoded(precision, samples, options);
  state.counters["real_time_factor"] =
      benchmark::Counter(kSeconds * static_cast<double>(state.iterations()),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  static const Tensor exact = encoded(EncoderPrecision::float32, samples, options);
  state.counters["error"] = relative_error(last, exact);
}

/// What cutting a clip into windows costs: error of all frames against the whole clip at once.
void windows(benchmark::State& state) {
  static const auto samples = noise_like_speech(30);
  static const Tensor exact = encoded(EncoderPrecision::float32, samples, {});
  EncodeOptions options;
  options.windows = {state.range(0), state.range(1), state.range(1)};
  Tensor last;
  for (auto _ : state) last = encoded(EncoderPrecision::float32, samples, options);
  state.counters["error"] = relative_error(last, exact);
}
BENCHMARK(windows)
    ->Name("encoder/windows")
    ->ArgNames({"frames", "context"})
    ->ArgsProduct({{100, 250, 500}, {25, 64, 128, 250}})
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond);

const bool registered = [] {
  const std::pair<const char*, EncoderPrecision> precisions[] = {{"float32", EncoderPrecision::float32},
                                                                 {"bfloat16", EncoderPrecision::bfloat16},
                                                                 {"int8", EncoderPrecision::int8}};
  for (const auto& [name, precision] : precisions) {
    if (!encoder_precision_available(precision)) continue;
    for (const int threads : {1, 2}) {
      auto* bench = benchmark::RegisterBenchmark(
          ("encoder/" + std::string(name) + "/threads=" + std::to_string(threads)).c_str(), encode, precision,
          threads);
      bench->Unit(benchmark::kMillisecond);
      // One thread: processor time, which other programs disturb less. More: only the clock counts.
      if (threads > 1) bench->UseRealTime();
    }
  }
  return true;
}();

}  // namespace
}  // namespace mien
