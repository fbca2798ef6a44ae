#include "mien/models/default/model_metadata.h"
#include "programs.h"
#include "step_reporter.h"

namespace mien::train {
namespace {

Status export_model(const TrainingConfig& config, const TrainingSet& set, Network& network,
                    const std::filesystem::path& path) {
  default_model::ModelMetadata metadata;
  metadata.name = config.run.name;
  metadata.sizes = config.sizes;
  metadata.look_ahead_mel_frames = config.options.look_ahead_mel_frames;
  metadata.training_config = config.run.text;
  metadata.training_set = set.description();
  return save_parameters(parameters(network), path, true, default_model::to_metadata(metadata));
}

// The names of a run's files.
struct WorkFiles {
  explicit WorkFiles(const std::filesystem::path& folder)
      : log(folder / "log.tsv"),
        features(folder / "features.safetensors"),
        mean(folder / "mean.checkpoint.safetensors"),
        diffusion(folder / "diffusion.checkpoint.safetensors"),
        blink(folder / "blink.checkpoint.safetensors"),
        brow(folder / "brow.checkpoint.safetensors") {}
  std::filesystem::path log, features, mean, diffusion, blink, brow;
};

Network initial_network(const TrainingConfig& config, const TrainingSet& set) {
  Network network(config.sizes);
  Initialise initialise(config.options.seed);
  network.visit(initialise);
  for (const auto& entry : parameters(network)) *entry.slot = entry.slot->detach().to(config.run.device);
  measure_face_statistics(set, network);
  return network;
}

}  // namespace

Status snapshot_default(const TrainingConfig& config, const std::filesystem::path& path,
                        ConsoleProgress& progress) {
  MIEN_TRY(const auto set, TrainingSet::open(config.run.data));
  const WorkFiles files(config.run.work_folder);
  Network network = initial_network(config, set);
  if (std::filesystem::exists(files.features)) {
    MIEN_TRY(const auto features, ChunkFeatures::open(files.features));
    measure_coefficient_sd(set, features, network, config.options);
  }
  Collect mean, diffusion, blink, brow;
  mean.scope("encoder", network.encoder);
  mean.scope("mean", network.mean);
  diffusion.scope("diffusion", network.diffusion);
  blink.scope("blink", network.blink);
  brow.scope("brow", network.brow);
  for (const auto& [stage, file] : {std::pair{&mean, &files.mean},
                                    {&diffusion, &files.diffusion},
                                    {&blink, &files.blink},
                                    {&brow, &files.brow}}) {
    if (!std::filesystem::exists(*file)) continue;
    MIEN_TRY(const auto step, load_stage_average(stage->entries, *file));
    progress.say(file->filename().string() + ": step " + std::to_string(step));
  }
  return export_model(config, set, network, path);
}

Status train_default(const TrainingConfig& config, ConsoleProgress& progress) {
  MIEN_TRY(const auto set, TrainingSet::open(config.run.data));
  MIEN_TRY([[maybe_unused]] const auto begun, config.run.begin());
  const WorkFiles files(config.run.work_folder);
  StepReporter log(files.log, progress);
  const auto report = [&](const StepReport& r) { log(r); };

  Network network = initial_network(config, set);

  MeanStage mean(set, network, config.options);
  log.begin("mean");
  MIEN_TRY([[maybe_unused]] const auto mean_done,
           run_stage(
               "mean path", mean.parameters(), config.mean, files.mean,
               [&](std::int64_t step) { return mean.loss(step); }, progress, report));
  progress.say("mean path: validation loss " + fixed(mean.validation_loss(20), 4));

  if (!std::filesystem::exists(files.features)) {
    MIEN_TRY([[maybe_unused]] const auto written,
             write_chunk_features(set, network, config.options, files.features, progress));
  }
  MIEN_TRY(const auto features, ChunkFeatures::open(files.features));
  measure_coefficient_sd(set, features, network, config.options);

  DiffusionStage diffusion(set, features, network, config.options);
  log.begin("diffusion");
  MIEN_TRY([[maybe_unused]] const auto diffusion_done,
           run_stage(
               "diffusion path", diffusion.parameters(), config.diffusion, files.diffusion,
               [&](std::int64_t step) { return diffusion.loss(step); }, progress, report));

  EventStage blink(set, features, network, config.options, EventStage::Events::blinks);
  log.begin("blink");
  MIEN_TRY([[maybe_unused]] const auto blink_done,
           run_stage(
               "blink path", blink.parameters(), config.blink, files.blink,
               [&](std::int64_t step) { return blink.loss(step); }, progress, report));

  EventStage brow(set, features, network, config.options, EventStage::Events::brow_raises);
  log.begin("brow");
  MIEN_TRY([[maybe_unused]] const auto brow_done,
           run_stage(
               "brow path", brow.parameters(), config.brow, files.brow,
               [&](std::int64_t step) { return brow.loss(step); }, progress, report));

  MIEN_TRY([[maybe_unused]] const auto saved, export_model(config, set, network, config.run.output));
  progress.say("wrote " + config.run.output.string());
  return Done{};
}

}  // namespace mien::train
