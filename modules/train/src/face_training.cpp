#include "mien/train/face_training.h"

#include <array>
#include <numeric>

#include "batch_tensors.h"
#include "mien/base/hash.h"
#include "mien/train/encoder_training.h"

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
  Tensor row = torch::zeros({1, 1, width});
  row.select(-1, index).fill_(1);
  return row.to(device);
}

// Whether the parameters whose names begin so are all frozen; "": all of the encoder's.
bool is_frozen(SpeechEncoder<Tensor>& encoder, std::string_view beginning) {
  const auto entries = parameters(encoder);
  return std::none_of(entries.begin(), entries.end(), [&](const Collect::Entry& e) {
    return e.name.starts_with(beginning) && e.slot->requires_grad();
  });
}

std::vector<std::size_t> shuffled(std::size_t count, std::uint64_t seed) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  Rng rng(seed);
  for (std::size_t i = count; i > 1; --i) std::swap(order[i - 1], order[rng.below(i)]);
  return order;
}

std::uint64_t seed_of(std::string_view purpose, std::uint64_t seed, std::int64_t index) {
  return hash_combine(hash64(purpose, seed), static_cast<std::uint64_t>(index));
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
      front_is_frozen_(is_frozen(network.encoder, "feature_")),
      encoder_is_frozen_(is_frozen(network.encoder, "")) {}

template <class Compute>
Tensor FaceStage::kept(const FaceSequence& sequence, Compute&& compute) {
  Tensor& kept = features_[sequence.name];
  if (!kept.defined()) {
    const torch::NoGradGuard no_grad;
    kept = compute();
  }
  return kept;
}

Tensor FaceStage::projected(const FaceSequence& sequence) {
  const auto compute = [&] {
    const auto length = static_cast<std::int64_t>(sequence.waveform.size());
    return network_.encoder.project(
        network_.encoder.extract(as_tensor(sequence.waveform, {1, length, 1}).to(options_.device)));
  };
  // Where nothing is random behind it, encode() keeps what the whole encoder makes instead.
  if (!front_is_frozen_ || !options_.cache_features || hears_the_same()) return compute();
  return kept(sequence, compute);
}

bool FaceStage::hears_the_same() const {
  return encoder_is_frozen_ && options_.cache_features && !options_.encoder_dropout && !options_.layer_drop &&
         !options_.spec_augment;
}

Tensor FaceStage::encode(const FaceSequence& sequence, Rng* random) {
  if (hears_the_same())
    return kept(sequence, [&] { return network_.encoder.transform(projected(sequence)); });
  if (random == nullptr) return network_.encoder.transform(projected(sequence));
  return transform_at_random(network_.encoder, projected(sequence), {},
                             {options_.encoder_dropout, options_.layer_drop, options_.spec_augment}, *random);
}

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
  return std::visit(
      [&](const auto& head) {
        using Head = std::decay_t<decltype(head)>;
        if constexpr (std::is_same_v<Head, facexhubert::Network<Tensor>>) {
          return head(speech, one_hot(sequence.subject, head.sizes.num_subjects, device),
                      one_hot(sequence.emotion, head.sizes.num_emotions, device), neutral(), nullptr, pass);
        } else {
          facediffuser::Conditions<Tensor> given;
          given.speech = head.speech_tokens(speech);
          if constexpr (std::is_same_v<Head, facediffuser::VertexDenoiser<Tensor>>) {
            given.style = head.style(one_hot(sequence.subject, head.sizes.num_subjects, device));
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
  const auto num_values = static_cast<std::int64_t>(sequence.motion.size());
  const auto unfit = [&](const std::string& why) {
    return Error{Errc::incompatible, "sequence '" + sequence.name + "'", why,
                 "Check the data: mien data check"};
  };
  if (num_values == 0 || num_values % width != 0)
    return unfit(std::to_string(num_values) + " numbers are no frames of " + std::to_string(width));
  if (!sequence.neutral.empty() && static_cast<std::int64_t>(sequence.neutral.size()) != width)
    return unfit("its neutral face has " + std::to_string(sequence.neutral.size()) + " numbers, a frame " +
                 std::to_string(width));
  const auto num_samples = static_cast<std::int64_t>(sequence.waveform.size());
  const std::int64_t num_features = network_.encoder.config.num_frames(num_samples);
  Alignment alignment = align_features(num_features, num_values / width, network_.fps);
  if (alignment.num_frames < 1) return unfit("its sound is too short for a frame");
  return alignment;
}

Result<FaceStage::Estimate> FaceStage::estimate(const FaceSequence& sequence, const Noisy& noisy,
                                                Rng* random) {
  MIEN_TRY(const Alignment alignment, align(sequence));
  Estimate result;
  result.speech = aligned(encode(sequence, random), alignment);
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
  const std::int64_t epoch = step / steps_per_epoch();
  if (epoch != epoch_) {
    order_ = shuffled(sequences_.num_train, seed_of("order", options_.seed, epoch));
    epoch_ = epoch;
  }
  return drawn_loss(FaceSequences::Split::train, order_[static_cast<std::size_t>(step % steps_per_epoch())],
                    seed_of("step", options_.seed, step));
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
