// WInD at the size of SAiD's protocol: features of 64 numbers for all windows of the two test speakers, 79
// sentences of about 4 s with 119 windows each, true and generated. One of the ten fits. The features are
// drawn from overlapping clusters, so that expectation and maximisation need several passes.
#include <benchmark/benchmark.h>

#include "mien/base/random.h"
#include "mien/metrics/wind.h"

namespace mien {
namespace {

constexpr std::int64_t kWidth = 64, kWindows = 79 * 119;

FeatureTable features(std::int64_t num_rows, std::uint64_t seed) {
  constexpr std::uint64_t kClusters = 8;
  Rng random(seed);
  FeatureTable table{kWidth, {}};
  table.values.reserve(static_cast<std::size_t>(num_rows * kWidth));
  std::vector<double> centres;
  for (std::uint64_t i = 0; i < kClusters * kWidth; ++i) centres.push_back(0.7 * random.normal());
  for (std::int64_t n = 0; n < num_rows; ++n) {
    const std::uint64_t cluster = random.below(kClusters);
    const double common = random.normal();
    for (std::uint64_t i = 0; i < kWidth; ++i)
      table.values.push_back(centres[cluster * kWidth + i] + 0.4 * common + 0.6 * random.normal());
  }
  return table;
}

// Argument: generated repetitions of each sentence.
void wind_once(benchmark::State& state) {
  const FeatureTable generated = features(kWindows * state.range(0), 1), truth = features(kWindows, 2);
  WindOptions options;
  options.num_repeats = 1;
  for (auto _ : state) benchmark::DoNotOptimize(wind(generated, truth, options).mean);
}

BENCHMARK(wind_once)
    ->Name("wind/one_fit")
    ->ArgName("repetitions")
    ->Arg(1)
    ->Arg(72)
    ->Iterations(1)
    ->Unit(benchmark::kSecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

}  // namespace
}  // namespace mien
