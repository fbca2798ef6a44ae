#include "mien/train/said_training.h"

#include <algorithm>

#include "batch_tensors.h"
#include "mien/base/contract.h"
#include "mien/base/hash.h"
#include "mien/train/encoder_training.h"

namespace mien::train {
namespace {

using torch::Tensor;
constexpr std::int64_t kSampleRateHz = 16000, kFps = 60;

/// Drops values in the denoiser's residual blocks.
struct DenoiserDropout {
  double probability = 0;
  [[nodiscard]] Tensor dropout(const Tensor& x) const {
    return torch::dropout(x, probability, /*train=*/true);
  }
  void stage(std::string_view /*module*/, std::string_view /*part*/, const Tensor& /*x*/) const {}
};

// floor(a / b) for b > 0, also of negative numbers.
std::int64_t floor_divide(std::int64_t a, std::int64_t b) { return a / b - (a % b < 0 ? 1 : 0); }

std::int64_t samples_of(std::int64_t num_frames) { return floor_divide(kSampleRateHz * num_frames, kFps); }

bool needs_no_gradient(SpeechEncoder<Tensor>& encoder) {
  const auto entries = parameters(encoder);
  return std::none_of(entries.begin(), entries.end(),
                      [](const Collect::Entry& e) { return e.slot->requires_grad(); });
}

// A factor of each window's level, [B, 1, 1].
template <class Part>
Tensor by_window(const std::vector<NoiseLevel>& levels, const Tensor& like, Part&& part) {
  std::vector<float> values;
  for (const NoiseLevel& level : levels) values.push_back(static_cast<float>(part(level)));
  return torch::tensor(values).reshape({-1, 1, 1}).to(like.device());
}

}  // namespace

void initialise_as_published(SaidNetwork& network, std::uint64_t seed) {
  Initialise start(seed);
  network.visit(start);
  draw_as_pytorch(parameters(network.head), seed);
}

SaidLoss said_loss(const Tensor& estimate, const Tensor& target, const SaidLossOptions& options) {
  const auto mean_error = [&](const Tensor& off) {
    return options.is_squared ? off.square().mean() : off.abs().mean();
  };
  const Tensor off =
      options.deviation.defined() ? (estimate - target) / options.deviation : estimate - target;
  SaidLoss loss;
  loss.prediction = mean_error(off);
  loss.velocity = mean_error(frame_differences(off));
  if (options.residuals.defined()) {
    const Tensor& all = options.residuals;
    const Tensor sizes = all.abs().flatten(1).mean(1).reshape({-1, 1, 1, 1});
    loss.vertices = mean_error(torch::matmul(off, (all / sizes).flatten(2)));
  }
  return loss;
}

Tensor said_target(Prediction prediction, const Tensor& x0, const Tensor& noise,
                   const std::vector<NoiseLevel>& levels) {
  if (prediction == Prediction::x0) return x0;
  if (prediction == Prediction::epsilon) return noise;
  return noise * by_window(levels, x0, [](const NoiseLevel& l) { return l.alpha; }) -
         x0 * by_window(levels, x0, [](const NoiseLevel& l) { return l.sigma; });
}

std::vector<float> said_sound_window(std::span<const float> waveform, std::int64_t first,
                                     std::int64_t num_frames, std::int64_t shift) {
  return replicated_window(waveform, 1, samples_of(first) + shift, samples_of(num_frames));
}

SaidStage::SaidStage(SaidNetwork& network, std::vector<CoefficientSequence> sequences,
                     std::vector<std::size_t> mirror, const SaidTrainingOptions& options)
    : network_(network),
      sequences_(std::move(sequences)),
      mirror_(std::move(mirror)),
      options_(options),
      batches_{static_cast<std::int64_t>(sequences_.size()), options.batch},
      process_(said::training_process(options.schedule, options.diffusion_steps)),
      encoder_is_frozen_(needs_no_gradient(network.encoder)) {
  const auto width = static_cast<std::size_t>(network.head.sizes.num_channels);
  contract(!sequences_.empty() && mirror_.size() == width,
           "SaidStage: sequences of the network's width are needed");
  for (const CoefficientSequence& s : sequences_)
    contract(!s.waveform.empty() && !s.coefficients.empty() && s.coefficients.size() % width == 0,
             "SaidStage: a sequence has no sound or no whole frames");
  if (!options_.deviation.empty()) {
    contract(options_.deviation.size() == width, "SaidStage: deviations of another width");
    deviation_ = torch::tensor(options_.deviation).to(options_.device);
  }
}

void SaidStage::draw_diffusion(SaidBatch& batch, Rng& random, std::uint64_t seed) const {
  const std::int64_t count = batch.coefficients.size(0);
  for (std::int64_t i = 0; i < count; ++i) {
    batch.conditioned.push_back(random.chance(options_.unconditional_probability) ? 0 : 1);
    batch.steps.push_back(
        static_cast<std::int64_t>(random.below(static_cast<std::uint64_t>(process_.size()))));
  }
  batch.noise = noise_tensor(seed, batch.coefficients.sizes().vec()).to(options_.device);
  batch.coefficients = batch.coefficients.to(options_.device);
  batch.waveform = batch.waveform.to(options_.device);
}

SaidBatch SaidStage::draw(std::int64_t step) const {
  const std::int64_t width = network_.head.sizes.num_channels, count = batches_.size(step);
  const std::uint64_t seed = hash_combine(hash64("said", options_.seed), static_cast<std::uint64_t>(step));
  Rng random(seed);
  std::vector<const CoefficientSequence*> chosen;  // with replacement
  // Sequences shorter than the shortest window go on with their last frame.
  const std::int64_t least = options_.shortest_window;
  std::int64_t longest = 0;
  for (std::int64_t i = 0; i < count; ++i) {
    chosen.push_back(&sequences_[random.below(sequences_.size())]);
    const std::int64_t length = std::max(least, chosen.back()->num_frames(width));
    longest = i == 0 ? length : std::min(longest, length);
  }
  const std::int64_t window =
      least + static_cast<std::int64_t>(random.below(static_cast<std::uint64_t>(longest - least + 1)));
  std::vector<float> coefficients, sound;
  for (const CoefficientSequence* s : chosen) {
    const std::int64_t first = draw_window_start(random, s->num_frames(width), window);
    const std::int64_t shift =
        random.chance(options_.shift_probability) ? static_cast<std::int64_t>(random.below(3)) - 1 : 0;
    std::vector<float> frames = replicated_window(s->coefficients, width, first, window);
    if (random.chance(options_.mirror_probability)) mirror_coefficients(frames, mirror_);
    coefficients.insert(coefficients.end(), frames.begin(), frames.end());
    std::vector<float> samples = said_sound_window(s->waveform, first, window, shift);
    const EncoderConfig& config = network_.encoder.config;
    if (config.do_normalize) normalise_waveform(samples, config.normalise_eps);
    sound.insert(sound.end(), samples.begin(), samples.end());
  }
  SaidBatch batch;
  batch.coefficients = as_tensor(coefficients, {count, window, width});
  batch.waveform = as_tensor(sound, {count, samples_of(window), 1});
  draw_diffusion(batch, random, seed);
  return batch;
}

SaidBatch SaidStage::whole(const CoefficientSequence& sequence, std::uint64_t seed) const {
  const std::int64_t width = network_.head.sizes.num_channels, count = sequence.num_frames(width);
  std::vector<float> sound = sequence.waveform;
  sound.resize(static_cast<std::size_t>(samples_of(count)));  // cut, or zeros behind it
  const EncoderConfig& config = network_.encoder.config;
  if (config.do_normalize) normalise_waveform(sound, config.normalise_eps);
  SaidBatch batch;
  batch.coefficients = as_tensor(sequence.coefficients, {1, count, width});
  batch.waveform = as_tensor(sound, {1, samples_of(count), 1});
  Rng random(seed);
  draw_diffusion(batch, random, seed);
  return batch;
}

Tensor SaidStage::encode(const SaidBatch& batch, Rng* random) const {
  const torch::AutoGradMode learns(!encoder_is_frozen_ && torch::GradMode::is_enabled());
  EncoderCall call;
  call.num_frames = batch.coefficients.size(1);
  const Tensor projected = network_.encoder.project(network_.encoder.extract(batch.waveform), call);
  if (random == nullptr) return network_.encoder.transform(projected, call);
  return transform_at_random(network_.encoder, projected, call,
                             {options_.encoder_dropout, options_.layer_drop, options_.spec_augment}, *random);
}

Tensor SaidStage::diffuse(const SaidBatch& batch) const {
  std::vector<NoiseLevel> levels;
  for (const std::int64_t step : batch.steps) levels.push_back(process_.level(step));
  const Tensor& x0 = batch.coefficients;
  return x0 * by_window(levels, x0, [](const NoiseLevel& l) { return l.alpha; }) +
         batch.noise * by_window(levels, x0, [](const NoiseLevel& l) { return l.sigma; });
}

Tensor SaidStage::estimate(const SaidBatch& batch, const Tensor& features, bool drops) const {
  const said::Network<Tensor>& head = network_.head;
  const Tensor speech = head.context(features);
  const auto count = static_cast<std::int64_t>(batch.conditioned.size());
  const Tensor with =
      torch::tensor(std::vector<std::int64_t>(batch.conditioned.begin(), batch.conditioned.end()))
          .reshape({count, 1, 1})
          .to(torch::kBool)
          .to(speech.device());
  const Tensor context = torch::where(with, speech, head.null_context(speech));
  const Tensor x_t = diffuse(batch);
  return drops ? head.denoiser(x_t, batch.steps, context, DenoiserDropout{options_.dropout})
               : head.denoiser(x_t, batch.steps, context);
}

SaidLoss SaidStage::loss_of(const SaidBatch& batch, const Tensor& estimate) const {
  return said_loss(estimate, batch.noise, {options_.is_squared, deviation_, {}});
}

Tensor SaidStage::total(const SaidLoss& loss) const {
  return loss.prediction + options_.velocity_weight * loss.velocity;
}

Tensor SaidStage::loss(std::int64_t step) {
  const SaidBatch batch = draw(step);
  const std::uint64_t seed = hash_combine(hash64("encoder", options_.seed), static_cast<std::uint64_t>(step));
  Rng random(seed);
  torch::manual_seed(mix64(seed));  // of dropout
  const Tensor features = encode(batch, &random);
  return total(loss_of(batch, estimate(batch, features, options_.dropout > 0)));
}

Result<double> SaidStage::validation_loss(const std::vector<CoefficientSequence>& sequences,
                                          std::int64_t num_passes, std::uint64_t seed) {
  const torch::NoGradGuard no_grad;
  double sum = 0;
  std::int64_t count = 0;
  for (const CoefficientSequence& s : sequences) {
    const std::int64_t num_frames = s.num_frames(network_.head.sizes.num_channels);
    if (network_.encoder.config.num_frames(samples_of(num_frames)) < 1)
      return Error{Errc::incompatible, "sequence '" + s.name + "'",
                   "is too short: " + std::to_string(num_frames) + " frames", ""};
    for (std::int64_t pass = 0; pass < num_passes; ++pass, ++count) {
      const SaidBatch batch =
          whole(s, hash_combine(hash64("validation", seed), static_cast<std::uint64_t>(count)));
      sum += total(loss_of(batch, estimate(batch, encode(batch, nullptr), false))).item<double>();
    }
  }
  return count == 0 ? 0 : sum / static_cast<double>(count);
}

}  // namespace mien::train
