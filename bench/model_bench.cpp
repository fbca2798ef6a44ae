// Speed of the default model: sound in memory to frames, offline and in packets of 20 ms.
#include <benchmark/benchmark.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <vector>

#include "default/hearing.h"
#include "default/performer.h"
#include "mien/base/random.h"
#include "mien/models/default/stream.h"
#include "mien/models/seeds.h"

namespace mien {
namespace {

constexpr double kSeconds = 10;

// Noise with the rhythm of syllables; speed does not depend on what is said.
const std::vector<float>& sound() {
  static const std::vector<float> samples = [] {
    std::vector<float> s(static_cast<std::size_t>(kSeconds * 16000));
    NoiseField(1, 0).normal(0, 0, s);
    for (std::size_t i = 0; i < s.size(); ++i)
      s[i] *= static_cast<float>(0.05 * (1 + std::sin(2 * 3.14159 * 4 * static_cast<double>(i) / 16000)));
    return s;
  }();
  return samples;
}

void perform(benchmark::State& state) {
  const auto model = DefaultModel::load(MIEN_SHARE_DIR "/default.safetensors");
  if (!model) return state.SkipWithError(model.error().message().c_str());
  const auto packet = static_cast<std::size_t>(state.range(0));
  PerformOptions options;
  options.num_steps = static_cast<int>(state.range(1));
  std::array<float, DefaultStream::kNumChannels> frame;
  for (auto _ : state) {
    DefaultStream stream(*model, options);
    const auto& samples = sound();
    for (std::size_t at = 0; at < samples.size(); at += packet) {
      stream.push(std::span(samples).subspan(at, std::min(packet, samples.size() - at)));
      while (stream.pop(frame)) benchmark::DoNotOptimize(frame);
    }
    stream.finish();
    while (stream.pop(frame)) benchmark::DoNotOptimize(frame);
  }
  state.counters["real_time_factor"] =
      benchmark::Counter(kSeconds * static_cast<double>(state.iterations()),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
// Takes of one recording: each hears for itself, or all at once (Hearing). Argument: takes.
const DefaultModel& default_model_file() {
  static const auto model = DefaultModel::load(MIEN_SHARE_DIR "/default.safetensors");
  return *model;
}

PerformOptions take_options(int take) {
  PerformOptions options;
  options.seed = performance_seed(0, take);
  return options;
}

void takes_apart(benchmark::State& state) {
  std::array<float, DefaultStream::kNumChannels> frame;
  for (auto _ : state)
    for (int take = 0; take < state.range(0); ++take) {
      DefaultStream stream(default_model_file(), take_options(take));
      stream.push(sound());
      stream.finish();
      while (stream.pop(frame)) benchmark::DoNotOptimize(frame);
    }
}

void takes_together(benchmark::State& state) {
  std::array<float, DefaultStream::kNumChannels> frame;
  for (auto _ : state) {
    default_model::Hearing hearing(default_model_file());
    std::vector<default_model::Performer> takes;
    takes.reserve(static_cast<std::size_t>(state.range(0)));
    for (int take = 0; take < state.range(0); ++take)
      takes.emplace_back(default_model_file(), take_options(take));
    hearing.push(sound());
    hearing.finish();
    default_model::Heard heard;
    while (takes.front().next() < hearing.num_frames() && hearing.hear(heard)) {
      for (auto& take : takes) {
        take.hear(heard);
        while (take.is_ready() && take.next() < hearing.num_frames()) take.compose(hearing, frame);
      }
      hearing.forget_before(takes.front().next());
    }
  }
}
BENCHMARK(takes_apart)->Name("model/takes_apart")->Arg(1)->Arg(4)->Unit(benchmark::kMillisecond);
BENCHMARK(takes_together)->Name("model/takes_together")->Arg(1)->Arg(4)->Unit(benchmark::kMillisecond);
BENCHMARK(perform)->Name("model/offline")->Args({16000, 8})->Unit(benchmark::kMillisecond);
BENCHMARK(perform)->Name("model/offline_16_steps")->Args({16000, 16})->Unit(benchmark::kMillisecond);
BENCHMARK(perform)->Name("model/packets_of_20_ms")->Args({320, 8})->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace mien
