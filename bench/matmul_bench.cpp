#include <benchmark/benchmark.h>

#include <string>
#include <vector>

#include "mien/base/random.h"
#include "mien/tensor/matmul.h"

namespace mien {
namespace {

struct Size {
  std::int64_t m, k, n;
};

void run(benchmark::State& state, Backend backend, Size size, int num_threads) {
  std::vector<float> weights(static_cast<std::size_t>(size.n * size.k)),
      x(static_cast<std::size_t>(size.m * size.k));
  std::vector<float> bias(static_cast<std::size_t>(size.n)), y(static_cast<std::size_t>(size.m * size.n));
  const NoiseField noise(1, 0);
  noise.normal(0, 0, weights);
  noise.normal(0, 1, x);
  const PackedMatrix packed(weights, size.n, size.k, backend);
  for (auto _ : state) {
    matmul({x.data(), size.m, size.k, size.k}, packed, bias.data(), y.data(), num_threads);
    benchmark::DoNotOptimize(y.data());
    benchmark::ClobberMemory();
  }
  state.counters["FLOP/s"] =
      benchmark::Counter(2.0 * static_cast<double>(size.m * size.k * size.n),
                         benchmark::Counter::kIsIterationInvariantRate, benchmark::Counter::kIs1000);
}

/// Products of the default model's encoder and GRU, for one frame, one chunk and a second.
const bool registered = [] {
  for (const auto& [k, n] : {std::pair<std::int64_t, std::int64_t>{480, 160}, {160, 160}, {256, 2304}}) {
    for (const std::int64_t m : {1, 12, 100}) {
      for (const auto backend :
           {Backend::rowwise, Backend::onednn, Backend::onednn_bf16, Backend::onednn_int8, Backend::eigen}) {
        if (!backend_available(backend)) continue;
        for (const int threads : {1, 2}) {
          const std::string name = "matmul/" + std::string(backend_name(backend)) +
                                   "/M=" + std::to_string(m) + "/K=" + std::to_string(k) +
                                   "/N=" + std::to_string(n) + "/threads=" + std::to_string(threads);
          auto* bench = benchmark::RegisterBenchmark(name.c_str(), run, backend, Size{m, k, n}, threads);
          // One thread: processor time, which other programs disturb less. More: only the clock counts.
          if (threads > 1) bench->UseRealTime();
        }
      }
    }
  }
  return true;
}();

}  // namespace
}  // namespace mien
