#include <array>
#include <cmath>

#include "condition_batch.h"
#include "mel_augmentation.h"
#include "mien/audio/running_level.h"
#include "mien/base/hash.h"

namespace mien::train {
namespace {

namespace dm = default_model;
constexpr std::int64_t kSkippedFrames =
    12;  // at the start of a crop the past is missing; do not learn from it

}  // namespace

torch::Tensor interpolate_to_motion_rate(const torch::Tensor& x, std::int64_t num_frames,
                                         std::int64_t shift) {
  const auto options = torch::TensorOptions().dtype(torch::kDouble);
  const auto position = torch::arange(num_frames, options) * (100.0 / 60.0) + static_cast<double>(shift);
  const auto left = (position + 1e-9).floor();
  const auto weight = (position - left).clamp_min(0).to(torch::kFloat).to(x.device()).unsqueeze(-1);
  const auto index = left.to(torch::kLong).clamp_max(x.size(1) - 1);
  const auto a = x.index_select(1, index.to(x.device()));
  const auto b = x.index_select(1, (index + 1).clamp_max(x.size(1) - 1).to(x.device()));
  return a + weight * (b - a);
}

void measure_face_statistics(const TrainingSet& set, Network& network) {
  std::array<double, kNumFace> sum{}, square{};
  std::array<float, kNumFace> face;
  double count = 0;
  for (const auto& e : set.entries()) {
    if (e.is_valid) continue;
    for (std::int64_t n = 0; n < e.num_frames; n += 7) {  // every 7th frame of every entry is plenty
      set.face(n / 7 % set.num_takes(), e.frame_start + n, face);
      for (std::size_t i = 0; i < face.size(); ++i) {
        sum[i] += face[i];
        square[i] += static_cast<double>(face[i]) * face[i];
      }
      ++count;
    }
  }
  for (std::size_t i = 0; i < face.size(); ++i) {
    const double mean = sum[i] / count, variance = square[i] / count - mean * mean;
    const auto at = static_cast<std::int64_t>(i);
    network.statistics.face_mean[at] = mean;
    network.statistics.face_sd[at] = std::max(0.01, std::sqrt(std::max(0.0, variance)));
  }
}

struct MeanStage::Batch {
  torch::Tensor mel;     // [B, M, 64]
  torch::Tensor face;    // [B, N, 45] raw
  torch::Tensor viseme;  // [B, N]
  torch::Tensor events;  // [B, N, 2]
  torch::Tensor counts;  // [B, N, 1] 1 where the frame counts
  dm::ConditionInput<torch::Tensor> condition;
};

MeanStage::MeanStage(const TrainingSet& set, Network& network, const DefaultTrainingOptions& options)
    : set_(set), network_(network), options_(options) {
  for (std::size_t i = 0; i < set.entries().size(); ++i)
    if (set.entries()[i].num_frames >= options.crop_frames + 3)
      (set.entries()[i].is_valid ? valid_entries_ : train_entries_).push_back(i);
  weights_ = torch::ones({kNumFace});
  weights_.narrow(0, kNumLower, kNumUpper).fill_(options.upper_weight);
  weights_ = weights_.to(options.device);
}

std::vector<Collect::Entry> MeanStage::parameters() {
  Collect collect;
  collect.scope("encoder", network_.encoder);
  collect.scope("mean", network_.mean);
  return collect.entries;
}

MeanStage::Batch MeanStage::draw(std::uint64_t seed, bool valid, bool with_augmentation) const {
  const std::int64_t num_batch = options_.mean_batch, num_frames = options_.crop_frames;
  const std::int64_t num_mel = num_frames * 5 / 3 + options_.look_ahead_mel_frames + 1;
  const auto& choices = valid ? valid_entries_ : train_entries_;
  contract(!choices.empty(), "the training set has no entry as long as a crop");
  std::vector<float> mel, face, events, counts;
  std::vector<std::int64_t> viseme;
  ConditionBatch condition(set_, with_augmentation ? options_.unknown_probability : 0);
  std::array<float, kNumFace> numbers;
  for (std::int64_t b = 0; b < num_batch; ++b) {
    Rng rng(hash_combine(seed, static_cast<std::uint64_t>(b)));
    const std::size_t index = choices[rng.below(choices.size())];
    const auto& entry = set_.entries()[index];
    const auto take = static_cast<std::int64_t>(rng.below(static_cast<std::uint64_t>(set_.num_takes())));
    const auto thirds = static_cast<std::uint64_t>((entry.num_frames - num_frames) / 3 + 1);
    const auto first = 3 * static_cast<std::int64_t>(rng.below(thirds));
    condition.add(take, index, rng);
    std::vector<float> crop(static_cast<std::size_t>(num_mel * dm::kMelBands), -14.0f);
    for (std::int64_t t = 0; t < num_mel; ++t) {
      const std::int64_t at = first * 5 / 3 + t;
      if (at < entry.num_mel)
        set_.relative_mel(entry.mel_start + at,
                          std::span(crop).subspan(static_cast<std::size_t>(t * dm::kMelBands), 64));
    }
    if (with_augmentation) augment_mel(crop, options_.level_offset_sd_db, rng);
    for (const float v : crop) mel.push_back(normalise_mel(v, 0.0f));
    for (std::int64_t n = 0; n < num_frames; ++n) {
      const std::int64_t at = entry.frame_start + first + n;
      set_.face(take, at, numbers);
      face.insert(face.end(), numbers.begin(), numbers.end());
      viseme.push_back(set_.viseme(at));
      events.push_back(set_.lips_closed(at));
      events.push_back(set_.accent(at));
      counts.push_back(n >= kSkippedFrames || first == 0 ? 1.0f : 0.0f);
    }
  }
  const auto make = [&](std::vector<float>& v, std::int64_t rows, std::int64_t width) {
    return torch::from_blob(v.data(), {num_batch, rows, width}).clone().to(options_.device);
  };
  return {make(mel, num_mel, dm::kMelBands),
          make(face, num_frames, kNumFace),
          torch::from_blob(viseme.data(), {num_batch, num_frames}, torch::kLong).clone().to(options_.device),
          make(events, num_frames, 2),
          make(counts, num_frames, 1),
          condition.tensors(options_.device)};
}

torch::Tensor MeanStage::loss_of(const Batch& batch) const {
  const auto at_motion_rate = interpolate_to_motion_rate(
      network_.encoder.encode_mel(batch.mel, nullptr), options_.crop_frames, options_.look_ahead_mel_frames);
  const auto features = network_.encoder.encode_frames(at_motion_rate, nullptr);
  const auto mean = network_.mean(features, network_.mean.condition(batch.condition), nullptr);
  const auto& sd = network_.statistics.face_sd;
  const auto truth = (batch.face - network_.statistics.face_mean) / sd;

  const auto average = [&](const torch::Tensor& x, const torch::Tensor& counts) {
    return (x * counts).sum() / (counts.sum() * x.size(-1));
  };
  const auto error = mean - truth;
  const auto difference = error.narrow(1, 1, error.size(1) - 1) - error.narrow(1, 0, error.size(1) - 1);
  const auto pair_counts = batch.counts.narrow(1, 0, error.size(1) - 1);
  auto loss = average(error.square() * weights_, batch.counts) +
              options_.difference_weight * average(difference.square() * weights_, pair_counts);
  // Lip aperture = jawOpen - mouthClose, in units of jawOpen's sd: what the eye sees of a closure.
  const auto aperture = error.narrow(-1, kFaceJawOpen, 1) -
                        error.narrow(-1, kFaceMouthClose, 1) * (sd[kFaceMouthClose] / sd[kFaceJawOpen]);
  loss = loss +
         options_.aperture_weight / static_cast<double>(kNumLower) * average(aperture.square(), batch.counts);
  const auto visemes = network_.encoder.visemes(features);
  loss = loss + options_.viseme_weight *
                    torch::nn::functional::cross_entropy(visemes.flatten(0, 1), batch.viseme.flatten());
  loss = loss + options_.event_weight *
                    torch::binary_cross_entropy_with_logits(network_.encoder.events(features), batch.events);
  return loss;
}

torch::Tensor MeanStage::loss(std::int64_t step) {
  return loss_of(draw(hash_combine(options_.seed, static_cast<std::uint64_t>(step)), false, true));
}

double MeanStage::validation_loss(std::int64_t num_batches) {
  const torch::NoGradGuard no_grad;
  if (valid_entries_.empty()) return 0;
  double sum = 0;
  for (std::int64_t i = 0; i < num_batches; ++i)
    sum += loss_of(draw(hash_combine(hash64("validation"), static_cast<std::uint64_t>(i)), true, false))
               .item<double>();
  return sum / static_cast<double>(num_batches);
}

}  // namespace mien::train
