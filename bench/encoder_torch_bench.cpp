// The slower way beside encoder_bench.cpp: the same HuBERT-base with the same weights on LibTorch, 10 s of
// sound, without gradients. error: relative rms of its last hidden state against the packed encoder in
// float32.
#include <benchmark/benchmark.h>
#include <torch/torch.h>

#include <memory>

#include "mien/models/speech_encoder/encoder_runtime.h"
#include "mien/nn/runtime_operations.h"
#include "mien/train/torch_operations.h"
#include "random_encoder.h"

namespace mien {
namespace {

constexpr double kSeconds = 10;

torch::Tensor encode_with_torch(const SpeechEncoder<torch::Tensor>& encoder, const torch::Tensor& waveform) {
  const torch::NoGradGuard no_gradients;
  return encoder(waveform, {});
}

void torch_encoder(benchmark::State& state) {
  const int usual = torch::get_num_threads();
  torch::set_num_threads(static_cast<int>(state.range(0)));
  SpeechEncoder<torch::Tensor> encoder{EncoderConfig{}};
  FillAtRandom fill([](const Shape& shape, std::vector<float>& values) {
    return torch::from_blob(values.data(), shape, torch::kFloat).clone();
  });
  encoder.visit(fill);
  std::vector<float> samples = noise_like_speech(kSeconds);
  normalise_waveform(samples, EncoderConfig().normalise_eps);
  const torch::Tensor waveform =
      torch::from_blob(samples.data(), {1, static_cast<std::int64_t>(samples.size()), 1}, torch::kFloat);
  torch::Tensor hidden = encode_with_torch(encoder, waveform);
  for (auto _ : state) hidden = encode_with_torch(encoder, waveform);
  state.counters["real_time_factor"] =
      benchmark::Counter(kSeconds * static_cast<double>(state.iterations()),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  torch::set_num_threads(usual);

  const auto packed = EncoderRuntime(random_encoder()).encode(noise_like_speech(kSeconds));
  if (!packed) return state.SkipWithError(packed.error().message().c_str());
  const torch::Tensor want =
      torch::from_blob(const_cast<float*>(packed->data()), packed->shape(), torch::kFloat);
  state.counters["error"] = ((hidden[0] - want).norm() / want.norm()).item<double>();
}
BENCHMARK(torch_encoder)
    ->Name("encoder/libtorch")
    ->ArgName("threads")
    ->Arg(1)
    ->Arg(2)
    ->UseRealTime()
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace mien
