#include <cmath>

#include "chunk_sequence.h"
#include "mien/base/hash.h"
#include "mien/models/default/chunk_code.h"
#include "mien/motion/schedule.h"

namespace mien::train {
namespace {

namespace dm = default_model;

torch::Tensor dct_tensor() {
  torch::Tensor m = torch::empty({dm::kChunkSamples, dm::kChunkSamples});
  for (std::int64_t k = 0; k < dm::kChunkSamples; ++k)
    for (std::int64_t i = 0; i < dm::kChunkSamples; ++i)
      m[k][i] = dm::dct_matrix()[static_cast<std::size_t>(k)][static_cast<std::size_t>(i)];
  return m;
}

// chunks, past [.., K, 6 U] -> coefficients [.., K, 6 U] of the difference from past's last sample.
torch::Tensor code(const torch::Tensor& chunks, const torch::Tensor& past, const torch::Tensor& dct) {
  const auto shape = chunks.sizes().vec();
  auto split = shape;
  split.back() = dm::kChunkSamples;
  split.push_back(kNumUpper);
  const auto samples = chunks.reshape(split);
  const auto last = past.reshape(split).narrow(-2, dm::kChunkSamples - 1, 1);
  return torch::matmul(dct, samples - last).reshape(shape);
}

torch::Tensor normal_tensor(std::vector<std::int64_t> shape, const NoiseField& field, std::uint32_t step) {
  torch::Tensor out = torch::empty(shape);
  field.normal(0, step, {out.data_ptr<float>(), static_cast<std::size_t>(out.numel())});
  return out;
}

}  // namespace

void measure_coefficient_sd(const TrainingSet& set, const ChunkFeatures& features, Network& network,
                            const DefaultTrainingOptions& options) {
  const auto entries = entries_of_at_least(set, options.sequence_chunks);
  const auto dct = dct_tensor();
  Rng rng(hash64("coefficient sd", options.seed));
  torch::Tensor square = torch::zeros({dm::kChunkSamples * kNumUpper});
  constexpr int kNumSequences = 400;
  for (int i = 0; i < kNumSequences; ++i) {
    auto sequence = draw_sequence(set, entries, options.sequence_chunks, rng);
    sequence.first_chunk = std::max<std::int64_t>(sequence.first_chunk, 1);  // ordinary chunks only
    const auto chunks = upper_chunks(set, features, network, sequence);
    square += code(chunks.narrow(0, 1, sequence.num_chunks), chunks.narrow(0, 0, sequence.num_chunks), dct)
                  .square()
                  .mean(0);
  }
  network.statistics.coefficient_sd.copy_((square / kNumSequences).sqrt().clamp_min(0.05));
}

DiffusionStage::DiffusionStage(const TrainingSet& set, const ChunkFeatures& features, Network& network,
                               const DefaultTrainingOptions& options)
    : set_(set),
      features_(features),
      network_(network),
      options_(options),
      entries_(entries_of_at_least(set, options.sequence_chunks)) {}

std::vector<Collect::Entry> DiffusionStage::parameters() {
  Collect collect;
  collect.scope("diffusion", network_.diffusion);
  return collect.entries;
}

torch::Tensor DiffusionStage::loss(std::int64_t step) {
  const std::int64_t num_batch = options_.sequence_batch, num_chunks = options_.sequence_chunks;
  const std::int64_t num_times = options_.times_per_chunk;
  const std::uint64_t seed =
      hash_combine(hash64("diffusion", options_.seed), static_cast<std::uint64_t>(step));
  const auto batch = draw_batch(set_, features_, entries_, options_, seed);
  std::vector<torch::Tensor> chunks;
  for (const auto& sequence : batch.sequences)
    chunks.push_back(upper_chunks(set_, features_, network_, sequence));
  const auto all = torch::stack(chunks);  // [B, K + 1, 6 U]
  auto past = all.narrow(1, 0, num_chunks).clone();
  const auto target_chunks = all.narrow(1, 1, num_chunks);

  // The model will read its own output, which is never exactly on course: show it a past that is off by an
  // offset per chunk and a little roughness, and let it learn to come back, since the target stays the true
  // chunk.
  const NoiseField field(seed, 1);
  const auto offset = normal_tensor({num_batch, num_chunks, 1, kNumUpper}, field, 0);
  const auto rough = normal_tensor({num_batch, num_chunks, dm::kChunkSamples, kNumUpper}, field, 1);
  // A channel that hardly moves in 200 ms is hardly disturbed.
  const auto typical_change =
      network_.statistics.coefficient_sd.cpu().narrow(0, 0, kNumUpper) / std::sqrt(6.0);
  const auto disturbance =
      ((offset + 0.3 * rough) * (typical_change / 0.3).clamp_max(1)).reshape({num_batch, num_chunks, -1});
  torch::Tensor amplitude = torch::empty({num_batch, 1, 1});
  for (std::int64_t b = 0; b < num_batch; ++b)
    amplitude[b] = options_.history_noise * field.uniform(static_cast<std::uint64_t>(b), 4);
  past += amplitude * disturbance;

  const auto dct = dct_tensor();
  const auto device = options_.device;
  const auto x0 = (code(target_chunks, past, dct) / network_.statistics.coefficient_sd.cpu()).to(device);
  default_model::DiffusionPath<torch::Tensor>::State state{
      torch::zeros({num_batch, 1, network_.sizes.diffusion_hidden}, device),
      torch::zeros({num_batch, 1, network_.sizes.diffusion_hidden}, device)};
  const auto c = network_.diffusion.condition(batch.condition);
  const auto h = network_.diffusion.read(past.to(device), batch.speech, c, state);

  // Several noise levels per chunk share the recurrent part.
  torch::Tensor alpha = torch::empty({num_times, num_batch, num_chunks, 1}), sigma = torch::empty_like(alpha),
                weight = torch::empty_like(alpha),
                time = torch::empty({num_times, num_batch, num_chunks, dm::kNumTimeFeatures});
  for (std::int64_t i = 0; i < alpha.numel(); ++i) {
    const double t = 0.001 + 0.997 * field.uniform(static_cast<std::uint64_t>(i), 2);
    const NoiseLevel level = cosine_level(t);
    alpha.data_ptr<float>()[i] = static_cast<float>(level.alpha);
    sigma.data_ptr<float>()[i] = static_cast<float>(level.sigma);
    const double snr = std::exp(2 * level.half_log_snr());
    weight.data_ptr<float>()[i] = static_cast<float>(std::min(snr + 1, options_.max_snr_weight));
    const auto features = dm::time_features(level.half_log_snr());
    std::copy(features.begin(), features.end(), time.data_ptr<float>() + i * dm::kNumTimeFeatures);
  }
  const auto epsilon =
      normal_tensor({num_times, num_batch, num_chunks, dm::kChunkSamples * kNumUpper}, field, 3).to(device);
  const auto x_t = alpha.to(device) * x0 + sigma.to(device) * epsilon;
  const auto estimate = network_.diffusion.predict_x0(h, x_t, time.to(device));
  return ((estimate - x0).square() * weight.to(device)).mean();
}

}  // namespace mien::train
