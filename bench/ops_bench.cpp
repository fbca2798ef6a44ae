#include <benchmark/benchmark.h>

#include <string>

#include "mien/base/random.h"
#include "mien/tensor/ops.h"

namespace mien {
namespace {

Tensor random_tensor(Shape shape, std::uint64_t seed) {
  Tensor t(std::move(shape));
  NoiseField(seed, 0).normal(0, 0, t.values());
  return t;
}

/// Values per second through one operation on [rows, 160], in place as networks use it.
void values(benchmark::State& state, Tensor (*operation)(Tensor)) {
  const Tensor x = random_tensor({state.range(0), 160}, 1);
  for (auto _ : state) {
    Tensor y = operation(x);
    benchmark::DoNotOptimize(y.data());
  }
  state.SetItemsProcessed(state.iterations() * x.count());
}

void gru(benchmark::State& state) {
  const std::int64_t m = state.range(0), width = 160;
  const Tensor x = random_tensor({m, width}, 1), h = random_tensor({m, width}, 2),
               b = random_tensor({3 * width}, 3);
  const PackedMatrix w(random_tensor({3 * width, width}, 4));
  for (auto _ : state) {
    Tensor y = gru_step(x, h, w, w, b, b);
    benchmark::DoNotOptimize(y.data());
  }
  state.counters["FLOP/s"] = benchmark::Counter(2.0 * static_cast<double>(m * 6 * width * width),
                                                benchmark::Counter::kIsIterationInvariantRate);
}

BENCHMARK_CAPTURE(values, copy, [](Tensor x) { return x; })->Arg(1)->Arg(100);
BENCHMARK_CAPTURE(values, exp, exp)->Arg(1)->Arg(100);
BENCHMARK_CAPTURE(values, sigmoid, sigmoid)->Arg(1)->Arg(100);
BENCHMARK_CAPTURE(values, tanh, tanh)->Arg(1)->Arg(100);
BENCHMARK_CAPTURE(values, gelu, gelu)->Arg(1)->Arg(100);
BENCHMARK_CAPTURE(values, softmax_last, softmax_last)->Arg(1)->Arg(100);
BENCHMARK_CAPTURE(values, layer_norm,
                  [](Tensor x) {
                    static const Tensor gamma = random_tensor({160}, 2);
                    return layer_norm(std::move(x), gamma, gamma);
                  })
    ->Arg(1)
    ->Arg(100);
BENCHMARK(gru)->Arg(1)->Arg(12)->Arg(100);

}  // namespace
}  // namespace mien
