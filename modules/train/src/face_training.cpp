#include "mien/train/face_training.h"

#include <array>

#include "batch_tensors.h"
#include "mien/base/contract.h"
#include "mien/base/hash.h"

namespace mien::train {
namespace {

using torch::Tensor;

Tensor motion_of(const FaceSequence& sequence, std::int64_t width, torch::Device device) {
  return as_tensor(sequence.motion, {1, static_cast<std::int64_t>(sequence.motion.size()) / width, width})
      .to(device);
}

Tensor neutral_of(const FaceSequence& sequence, torch::Device device) {
  return as_tensor(sequence.neutral, {1, 1, static_cast<std::int64_t>(sequence.neutral.size())}).to(device);
}

Tensor one_hot(std::int64_t index, std::int64_t width, torch::Device device) {
  return as_tensor(one_hot_weights(index, width), {1, 1, width}).to(device);
}

}  // namespace

std::optional<AudioMask> parse_audio_mask(std::string_view name) {
  constexpr std::array<std::string_view, 5> kNames = {"none", "full_zero", "full_random", "partial_zero",
                                                      "partial_random"};
  for (std::size_t i = 0; i < kNames.size(); ++i)
    if (kNames[i] == name) return static_cast<AudioMask>(i);
  return std::nullopt;
}

FaceStage::FaceStage(FaceNetwork& network, FaceSequences sequences, const FaceTrainingOptions& options)
    : network_(network),
      sequences_(std::move(sequences)),
      options_(options),
      process_(betas_of(options.schedule, options.diffusion_steps)),
      encoder_(network.encoder, {options.encoder_dropout, options.layer_drop, options.spec_augment},
               options.device, options.cache_features),
      order_(sequences_.num_train, options.seed) {}

Tensor FaceStage::masked(const Tensor& speech, Rng& random) const {
  const AudioMask kind = options_.mask;
  if (kind == AudioMask::none) return speech;
  const bool whole = kind == AudioMask::full_zero || kind == AudioMask::full_random;
  const bool covers_all = random.chance(options_.mask_share);
  Tensor covered = torch::empty({1, speech.size(1), 1}, torch::kBool);
  for (std::int64_t n = 0; n < speech.size(1); ++n)
    covered.data_ptr<bool>()[n] = whole ? covers_all : random.chance(options_.mask_share);
  const bool noisy = kind == AudioMask::full_random || kind == AudioMask::partial_random;
  const std::uint64_t seed = (std::uint64_t{random.bits()} << 32) | random.bits();
  const Tensor cover =
      noisy ? noise_tensor(seed, {1, speech.size(1), speech.size(2)}) : torch::zeros(speech.sizes());
  return torch::where(covered.to(speech.device()), cover.to(speech.device()), speech);
}

Tensor FaceStage::diffuse(const Tensor& x0, const Tensor& noise, std::int64_t step) const {
  const NoiseLevel level = process_.level(step);
  return x0 * level.alpha + noise * level.sigma;
}

Tensor FaceStage::predict(const FaceSequence& sequence, const Tensor& speech, const Noisy& noisy,
                          const DecoderPass<Tensor>& pass) const {
  const auto device = options_.device;
  const auto neutral = [&] { return neutral_of(sequence, device); };
  const auto style = [&] {
    const std::int64_t columns = network_.num_styles();
    contract(static_cast<std::int64_t>(sequence.style.size()) == columns,
             "FaceStage: a sequence has another style");
    return as_tensor(sequence.style, {1, 1, columns}).to(device);
  };
  return std::visit(
      [&](const auto& head) {
        using Head = std::decay_t<decltype(head)>;
        if constexpr (std::is_same_v<Head, facexhubert::Network<Tensor>>) {
          return head(speech, style(), one_hot(sequence.emotion, head.sizes.num_emotions, device), neutral(),
                      nullptr, pass);
        } else {
          facediffuser::Conditions<Tensor> given;
          given.speech = head.speech_tokens(speech);
          if constexpr (std::is_same_v<Head, facediffuser::VertexDenoiser<Tensor>>) {
            given.style = head.style(style());
            given.neutral = neutral();
          }
          if (!head.sizes.is_diffusion()) return head.predict_x0({}, given, 0, pass);
          return head.predict_x0(noisy.x_t.narrow(1, 0, speech.size(1)), given, noisy.step, pass);
        }
      },
      network_.head);
}

Result<Alignment> FaceStage::align(const FaceSequence& sequence) const {
  const std::int64_t width = network_.num_channels();
  const auto neutral = static_cast<std::int64_t>(sequence.neutral.size());
  if (neutral != 0 && neutral != width)
    return Error{
        Errc::incompatible, "sequence '" + sequence.name + "'",
        "its neutral face has " + std::to_string(neutral) + " numbers, a frame " + std::to_string(width),
        "Check the data: mien data check"};
  return align_sequence(sequence, width, network_.encoder.config, network_.fps);
}

Result<FaceStage::Estimate> FaceStage::estimate(const FaceSequence& sequence, const Noisy& noisy,
                                                Rng* random) {
  MIEN_TRY(const Alignment alignment, align(sequence));
  Estimate result;
  result.speech = aligned(encoder_(sequence.name, sequence.waveform, random), alignment);
  if (random != nullptr) result.speech = masked(result.speech, *random);
  result.target =
      motion_of(sequence, network_.num_channels(), options_.device).narrow(1, 0, alignment.num_frames);
  DecoderPass<Tensor> pass;
  if (random != nullptr && options_.decoder_dropout > 0)
    pass.drop = [this](Tensor h) { return torch::dropout(h, options_.decoder_dropout, /*train=*/true); };
  const Tensor offsets =
      sequence.neutral.empty() ? result.target : result.target - neutral_of(sequence, options_.device);
  if (random != nullptr && options_.teacher_forcing) pass.written = &offsets;
  result.motion = predict(sequence, result.speech, noisy, pass);
  return result;
}

Tensor FaceStage::loss_of(const Estimate& e) const {
  return options_.loss == MotionLoss::huber
             ? torch::huber_loss(e.motion, e.target, at::Reduction::Mean, /*delta=*/1.0)
             : torch::mse_loss(e.motion, e.target);
}

Result<Tensor> FaceStage::drawn_loss(FaceSequences::Split split, std::size_t index, std::uint64_t seed) {
  MIEN_TRY(const FaceSequence sequence, sequences_.load(split, index));
  MIEN_TRY([[maybe_unused]] const Alignment fits, align(sequence));
  Rng random(seed);
  Noisy noisy;
  if (network_.is_diffusion()) {
    noisy.step = static_cast<std::int64_t>(random.below(static_cast<std::uint64_t>(process_.size())));
    const Tensor x0 = motion_of(sequence, network_.num_channels(), options_.device);
    noisy.x_t = diffuse(x0, noise_tensor(seed, x0.sizes().vec()).to(options_.device), noisy.step);
  }
  torch::manual_seed(mix64(seed));  // of dropout
  MIEN_TRY(const Estimate made,
           estimate(sequence, noisy, split == FaceSequences::Split::train ? &random : nullptr));
  return loss_of(made);
}

Result<Tensor> FaceStage::loss(std::int64_t step) {
  return drawn_loss(FaceSequences::Split::train, order_.at(step), seed_of("step", options_.seed, step));
}

Result<double> FaceStage::validation_loss(std::int64_t epoch) {
  const torch::NoGradGuard no_grad;
  double sum = 0;
  for (std::size_t i = 0; i < sequences_.num_valid; ++i) {
    const auto seed = hash_combine(seed_of("validation", options_.seed, epoch), i);
    MIEN_TRY(const Tensor value, drawn_loss(FaceSequences::Split::valid, i, seed));
    sum += value.item<double>();
  }
  return sequences_.num_valid == 0 ? 0 : sum / static_cast<double>(sequences_.num_valid);
}

}  // namespace mien::train
