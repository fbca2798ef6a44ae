#include "mien/train/probtalk3d_training.h"

#include <algorithm>
#include <numeric>

#include "batch_tensors.h"
#include "mien/base/contract.h"
#include "mien/base/hash.h"
#include "mien/models/probtalk3d/validation.h"
#include "mien/train/torch_parameters.h"

namespace mien::train::probtalk3d {
namespace {

using torch::Tensor;
namespace network = mien::probtalk3d;
constexpr double kFps = 25;  // of two speech features a frame

void fill_codebook(Prior& prior, std::uint64_t seed) {
  if (prior.sizes.is_variational()) return;
  const torch::NoGradGuard no_grad;
  fill_uniform(prior.quantiser.codebook, 1 / static_cast<double>(prior.sizes.num_codes),
               Rng(hash64("codebook", seed)));
}

Status check_length(const FaceSequence& sequence, std::int64_t num_frames) {
  if (num_frames >= 2 && num_frames <= network::kMostFrames) return Done{};
  return Error{Errc::incompatible, "sequence '" + sequence.name + "'",
               "has " + std::to_string(num_frames) + " frames to learn from, not 2 to " +
                   std::to_string(network::kMostFrames),
               "Leave it out of the data, or cut it"};
}

Tensor rows_of(const FaceSequence& sequence, std::int64_t num_frames, std::int64_t width,
               torch::Device device) {
  const auto all = static_cast<std::int64_t>(sequence.motion.size()) / width;
  return as_tensor(sequence.motion, {1, all, width}).narrow(1, 0, num_frames).to(device);
}

mien::Tensor on_runtime(const Tensor& rows) {
  return mien::Tensor({rows.size(1), rows.size(2)}, Operations<Tensor>::values(rows));
}

// Sums of a validation; means() at its end.
class Figures {
 public:
  void add(const Losses& losses, const Latent& latent, std::int64_t num_codes, const Tensor& motion,
           const Tensor& truth) {
    sums_.losses.push_back(losses.total.item<double>());
    sums_.expression += losses.expression.item<double>();
    sums_.jaw += losses.jaw.item<double>();
    if (num_codes > 0) sums_.perplexity += network::code_perplexity(latent.codes.codes, num_codes);
    const auto distance = network::motion_distance(on_runtime(motion), on_runtime(truth));
    sums_.mean_l2 += distance.mean_l2;
    sums_.mean_var += distance.mean_var;
  }
  [[nodiscard]] Validation means() const {
    Validation v = sums_;
    const auto count = static_cast<double>(std::max<std::size_t>(1, v.losses.size()));
    for (double* figure : {&v.expression, &v.jaw, &v.perplexity, &v.mean_l2, &v.mean_var}) *figure /= count;
    return v;
  }

 private:
  Validation sums_;
};

}  // namespace

double Validation::mean_loss() const {
  return losses.empty()
             ? 0
             : std::accumulate(losses.begin(), losses.end(), 0.0) / static_cast<double>(losses.size());
}

void initialise_as_published(Prior& prior, std::uint64_t seed) {
  Initialise start(seed);
  prior.visit(start);
  draw_as_pytorch(parameters(prior), seed);
  fill_codebook(prior, seed);
}

void initialise_as_published(TalkingNetwork& whole, std::uint64_t seed) {
  Initialise start(seed);
  whole.visit(start);
  draw_as_pytorch(parameters(whole.network), seed);
  fill_codebook(whole.network.prior, seed);
}

PriorStage::PriorStage(Prior& prior, FaceSequences sequences, const StageSettings& settings)
    : prior_(prior),
      sequences_(std::move(sequences)),
      settings_(settings),
      order_(sequences_.num_train, settings.seed) {}

Result<PriorPass> PriorStage::pass(const FaceSequence& sequence, std::uint64_t seed, double dropout) const {
  const std::int64_t width = prior_.sizes.channels;
  MIEN_TRY(const std::int64_t num_frames, num_frames_of(sequence, width));
  MIEN_TRY([[maybe_unused]] const auto fits, check_length(sequence, num_frames));
  Tensor noise;
  if (prior_.sizes.is_variational())
    noise = noise_tensor(seed, {1, num_frames, prior_.sizes.width}).to(settings_.device);
  torch::manual_seed(mix64(seed));  // of dropout
  PriorOptions options = settings_.prior;
  options.dropout = dropout;
  return pass_prior(prior_, rows_of(sequence, num_frames, width, settings_.device), noise, options);
}

Result<Tensor> PriorStage::loss(std::int64_t step) {
  MIEN_TRY(const FaceSequence sequence, sequences_.load(FaceSequences::Split::train, order_.at(step)));
  MIEN_TRY(const PriorPass made,
           pass(sequence, seed_of("prior", settings_.seed, step), settings_.prior.dropout));
  return made.losses.total;
}

Result<Validation> PriorStage::validate(std::int64_t epoch) {
  const torch::NoGradGuard no_grad;
  Figures figures;
  for (std::size_t i = 0; i < sequences_.num_valid; ++i) {
    MIEN_TRY(const FaceSequence sequence, sequences_.load(FaceSequences::Split::valid, i));
    MIEN_TRY(const PriorPass made,
             pass(sequence, hash_combine(seed_of("validation", settings_.seed, epoch), i), 0));
    figures.add(made.losses, made.latent, prior_.sizes.num_codes, made.motion,
                rows_of(sequence, made.motion.size(1), prior_.sizes.channels, torch::kCPU));
  }
  return figures.means();
}

struct PredictorStage::Pass {
  Latent latent;
  Tensor motion, truth;
  Losses losses;
};

PredictorStage::PredictorStage(TalkingNetwork& whole, FaceSequences sequences,
                               const PredictorSettings& settings)
    : network_(whole),
      sequences_(std::move(sequences)),
      settings_(settings),
      encoder_(whole.encoder, settings.encoder, settings.device, settings.keeps_features),
      order_(sequences_.num_train, settings.seed) {}

Result<PredictorStage::Pass> PredictorStage::pass(const FaceSequence& sequence, std::uint64_t seed,
                                                  bool is_training) {
  const network::Sizes& sizes = network_.network.sizes;
  const Prior& prior = network_.network.prior;
  MIEN_TRY(const Alignment alignment, align_sequence(sequence, sizes.channels, encoder_.config(), kFps));
  MIEN_TRY([[maybe_unused]] const auto fits, check_length(sequence, alignment.num_frames));
  contract(static_cast<std::int64_t>(sequence.style.size()) == sizes.style,
           "PredictorStage: a sequence has another style");
  Tensor noise, noise_of_truth;
  if (sizes.is_variational()) {
    const std::vector<std::int64_t> shape = {1, alignment.num_frames, sizes.width};
    noise = noise_tensor(hash_combine(seed, 1), shape).to(settings_.device);
    noise_of_truth = noise_tensor(hash_combine(seed, 2), shape).to(settings_.device);
  }
  torch::manual_seed(mix64(seed));  // of dropout
  Rng random(seed);
  const PositionDropout own{is_training ? settings_.dropout : 0},
      in_prior{is_training ? settings_.prior_dropout : 0};
  Pass made;
  made.truth = rows_of(sequence, alignment.num_frames, sizes.channels, settings_.device);
  const Tensor features = encoder_(sequence.name, sequence.waveform, is_training ? &random : nullptr);
  const Tensor style = as_tensor(sequence.style, {1, 1, sizes.style}).to(settings_.device);
  const Tensor z = network_.network.predictor(aligned(features, alignment), style, own);
  Latent reference;
  {
    const torch::NoGradGuard no_grad;  // nothing of it learns
    reference = latent_of(prior, prior.encoder(made.truth, in_prior), noise_of_truth);
  }
  made.latent = latent_of(prior, z, noise);
  made.motion = prior.decoder(made.latent.values, in_prior);
  made.losses = motion_losses((made.latent.values - reference.values).abs().mean(), made.motion, made.truth,
                              settings_.weights, settings_.jaw);
  return made;
}

Result<Tensor> PredictorStage::loss(std::int64_t step) {
  MIEN_TRY(const FaceSequence sequence, sequences_.load(FaceSequences::Split::train, order_.at(step)));
  MIEN_TRY(const Pass made, pass(sequence, seed_of("predictor", settings_.seed, step), true));
  return made.losses.total;
}

Result<Validation> PredictorStage::validate(std::int64_t epoch) {
  const torch::NoGradGuard no_grad;
  Figures figures;
  for (std::size_t i = 0; i < sequences_.num_valid; ++i) {
    MIEN_TRY(const FaceSequence sequence, sequences_.load(FaceSequences::Split::valid, i));
    MIEN_TRY(const Pass made,
             pass(sequence, hash_combine(seed_of("validation", settings_.seed, epoch), i), false));
    figures.add(made.losses, made.latent, network_.network.sizes.num_codes, made.motion, made.truth);
  }
  return figures.means();
}

}  // namespace mien::train::probtalk3d
