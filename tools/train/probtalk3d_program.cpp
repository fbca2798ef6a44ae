#include <algorithm>

#include "emotional_data.h"
#include "mien/core/flame_parameters.h"
#include "mien/models/model_file.h"
#include "programs.h"

namespace mien::train {
namespace {

using probtalk3d::Prior;
using probtalk3d::TalkingNetwork;
using torch::Tensor;

// Adam as both stages have it (specification, sections 6.5 and 7.5).
StageOptions published_adam(std::int64_t num_steps, double rate, double weight_decay,
                            std::int64_t checkpoint_every) {
  auto options = StageOptions::plain_adam(num_steps, rate);
  options.beta2 = 0.98;
  options.epsilon = 1e-9;
  options.weight_decay = weight_decay;
  options.decays_vectors = true;
  options.checkpoint_every = checkpoint_every;
  return options;
}

ModelFile described(const RunConfig& run, Architecture architecture, const EmotionalData& data,
                    std::int64_t heads) {
  ModelFile m;
  m.architecture = architecture;
  m.name = run.name.empty() ? run.system : run.name;
  data.describe(m);
  m.sizes["heads"] = heads;
  m.training_config = run.text;
  return m;
}

/// Everything that a run of stage 1 is made of.
struct PriorRun {
  EmotionalData data;
  ModelFile description;
  std::unique_ptr<Prior> prior;
};

Result<PriorRun> prepare(const ProbTalk3DPriorConfig& config, ConsoleProgress& progress) {
  PriorRun run;
  EmotionalDataOptions wanted;
  wanted.kind = DatasetKind::mead_prior;
  wanted.num_expression = config.num_expression;
  wanted.corpus = config.corpus;
  MIEN_TRY(run.data, open_emotional_data(config.run.data, wanted, progress));
  run.description = described(config.run, Architecture::probtalk3d_prior, run.data, config.sizes.heads);
  for (auto* names : {&run.description.subjects, &run.description.emotions, &run.description.intensities})
    names->clear();  // it has no styles
  auto sizes = config.sizes;
  sizes.channels = run.data.output.channels;
  run.prior = std::make_unique<Prior>(sizes);
  probtalk3d::initialise_as_published(*run.prior, config.options.seed);
  for (const auto& e : parameters(*run.prior)) *e.slot = e.slot->detach().to(config.options.device);
  return run;
}

Status write_model(Prior& prior, const ModelFile& description, const std::filesystem::path& path) {
  return save_parameters(parameters(prior), path, false, to_metadata(description));
}

/// The prior that stage 2 starts from.
struct StoredPrior {
  SafetensorsFile file;
  ModelFile description;
  mien::probtalk3d::Sizes sizes;
  std::string name;
};

Result<StoredPrior> open_prior(const std::filesystem::path& path) {
  const std::string name = "'" + path.string() + "'";
  MIEN_TRY(auto file, SafetensorsFile::open(path));
  const auto description = read_model_file(file.metadata());
  if (!description) return within(description.error(), name);
  if (description->architecture != Architecture::probtalk3d_prior)
    return Error{Errc::incompatible, name,
                 "is no motion prior but '" + std::string(architecture_name(description->architecture)) + "'",
                 "Train one first: mien train configs/probtalk3d_prior.toml"};
  const auto heads = description->sizes.find("heads");
  const auto sizes =
      mien::probtalk3d::sizes_of(stored_shapes(file), heads == description->sizes.end() ? 0 : heads->second);
  if (!sizes) return within(sizes.error(), name);
  if (sizes->channels != description->output.channels)
    return Error{Errc::incompatible, name, "says another number of channels than its weights have", ""};
  return StoredPrior{std::move(file), *description, *sizes, name};
}

// What stage 1 was trained on must be what stage 2 is.
Status check_alike(const StoredPrior& prior, const EmotionalData& data) {
  const ModelOutput &learnt = prior.description.output, &given = data.output;
  if (learnt.space == given.space && learnt.channels == given.channels && learnt.fps == given.fps)
    return Done{};
  const auto words = [](const ModelOutput& o) {
    return std::to_string(o.channels) + " channels of the space " + o.space;
  };
  return Error{Errc::incompatible, prior.name,
               "was trained on " + words(learnt) + ", the data have " + words(given),
               "Train stage 1 on the same data"};
}

/// Everything that a run of stage 2 is made of.
struct TalkingRun {
  EmotionalData data;
  ModelFile description;
  std::unique_ptr<TalkingNetwork> network;
  std::vector<Collect::Entry> learning;
};

Result<TalkingRun> prepare(const ProbTalk3DConfig& config, ConsoleProgress& progress) {
  TalkingRun run;
  MIEN_TRY(const StoredPrior prior, open_prior(config.prior));
  MIEN_TRY(const auto source, open_encoder(config.encoder, config.options.encoder.spec_augment));
  EmotionalDataOptions wanted;
  wanted.sound = {source.config, /*stretches=*/true};
  wanted.subjects = config.subjects;
  constexpr auto kMost = static_cast<std::int64_t>(kNumFlameExpression);
  wanted.num_expression =
      std::clamp<std::int64_t>(prior.sizes.channels - mien::probtalk3d::kNumJaw, 1, kMost);
  wanted.corpus = config.corpus;
  MIEN_TRY(run.data, open_emotional_data(config.run.data, wanted, progress));
  MIEN_TRY([[maybe_unused]] const auto alike, check_alike(prior, run.data));
  auto sizes = prior.sizes;
  sizes.predictor_blocks = config.num_blocks;
  sizes.condition = 2 * source.config.hidden_size;
  run.description = described(config.run, Architecture::probtalk3d, run.data, sizes.heads);
  run.description.encoder = source.config;
  run.description.scaler = prior.description.scaler;
  const ModelFile& m = run.description;
  sizes.style = static_cast<std::int64_t>(m.subjects.size() + m.emotions.size() + m.intensities.size());
  run.network.reset(
      new TalkingNetwork{SpeechEncoder<Tensor>(source.config), mien::probtalk3d::Network<Tensor>(sizes)});
  probtalk3d::initialise_as_published(*run.network, config.options.seed);
  MIEN_TRY([[maybe_unused]] const auto loaded, source.load_into(run.network->encoder));
  const Status known = load_parameters(parameters(run.network->network.prior), prior.file);
  if (!known) return within(known.error(), prior.name);
  for (const auto& e : parameters(*run.network)) *e.slot = e.slot->detach().to(config.options.device);
  auto frozen = config.frozen;
  frozen.emplace_back("motion_prior");
  MIEN_TRY(run.learning, freeze(parameters(*run.network), frozen));
  return run;
}

Status write_model(TalkingRun& run, const std::filesystem::path& path) {
  return save_parameters(parameters(*run.network), path, false, to_metadata(run.description));
}

}  // namespace

Status train_probtalk3d_prior(const ProbTalk3DPriorConfig& config, ConsoleProgress& progress) {
  MIEN_TRY(PriorRun run, prepare(config, progress));
  MIEN_TRY([[maybe_unused]] const auto begun, config.run.begin());
  auto settings = config.options;
  settings.prior.jaw = run.data.jaw;
  const bool has_validation = run.data.sequences.num_valid > 0;
  probtalk3d::PriorStage stage(*run.prior, std::move(run.data.sequences), settings);
  return run_until_stopped(
      config.run, config.stopping,
      {parameters(*run.prior),
       published_adam(config.num_epochs * stage.steps_per_epoch(), config.learning_rate, config.weight_decay,
                      config.checkpoint_every),
       stage.steps_per_epoch(), has_validation, [&](std::int64_t step) { return stage.loss(step); },
       [&](std::int64_t epoch) { return stage.validate(epoch); },
       [&](const std::filesystem::path& path) { return write_model(*run.prior, run.description, path); }},
      progress);
}

Status snapshot_probtalk3d_prior(const ProbTalk3DPriorConfig& config, const std::filesystem::path& path,
                                 ConsoleProgress& progress) {
  MIEN_TRY(PriorRun run, prepare(config, progress));
  return snapshot_of_stopped(
      config.run, config.stopping, parameters(*run.prior),
      [&](const std::filesystem::path& to) { return write_model(*run.prior, run.description, to); }, path,
      progress);
}

Status train_probtalk3d(const ProbTalk3DConfig& config, ConsoleProgress& progress) {
  MIEN_TRY(TalkingRun run, prepare(config, progress));
  MIEN_TRY([[maybe_unused]] const auto begun, config.run.begin());
  auto settings = config.options;
  settings.jaw = run.data.jaw;
  const bool has_validation = run.data.sequences.num_valid > 0;
  probtalk3d::PredictorStage stage(*run.network, std::move(run.data.sequences), settings);
  return run_until_stopped(
      config.run, config.stopping,
      {run.learning,
       published_adam(config.num_epochs * stage.steps_per_epoch(), config.learning_rate, 0,
                      config.checkpoint_every),
       stage.steps_per_epoch(), has_validation, [&](std::int64_t step) { return stage.loss(step); },
       [&](std::int64_t epoch) { return stage.validate(epoch); },
       [&](const std::filesystem::path& path) { return write_model(run, path); }},
      progress);
}

Status snapshot_probtalk3d(const ProbTalk3DConfig& config, const std::filesystem::path& path,
                           ConsoleProgress& progress) {
  MIEN_TRY(TalkingRun run, prepare(config, progress));
  return snapshot_of_stopped(
      config.run, config.stopping, run.learning,
      [&](const std::filesystem::path& to) { return write_model(run, to); }, path, progress);
}

}  // namespace mien::train
