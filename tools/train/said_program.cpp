#include "corpus_coefficients.h"
#include "encoder_source.h"
#include "epoch_run.h"
#include "mien/base/hash.h"
#include "mien/base/number_text.h"
#include "mien/core/arkit.h"
#include "mien/corpus/corpus_reader.h"
#include "mien/models/model_file.h"
#include "programs.h"

namespace mien::train {
namespace {

using torch::Tensor;

/// Everything that a run is made of.
struct SaidRun {
  ModelFile description;
  std::unique_ptr<SaidNetwork> network;
  std::vector<Collect::Entry> learning;
};

ModelFile describe(const SaidConfig& config, const said::Sizes& sizes, const EncoderConfig& encoder) {
  ModelFile m;
  m.architecture = Architecture::said;
  m.name = config.run.name.empty() ? config.run.system : config.run.name;
  m.output = {.space = "arkit", .channels = sizes.num_channels, .fps = kCoefficientFps, .topology = ""};
  m.encoder = encoder;
  m.diffusion = {std::string(beta_schedule_name(config.options.schedule)), config.options.diffusion_steps};
  if (!sizes.is_aligned) m.sizes["alignment_bias"] = 0;
  m.licence = "that of the coefficients, the sound and the speech encoder it was trained on";
  m.training_config = config.run.text;
  m.training_set = is_corpus(config.run.data) ? "{\"layout\": \"corpus\"}" : "{\"layout\": \"coefficients\"}";
  return m;
}

Result<SaidRun> prepare(const SaidConfig& config) {
  SaidRun run;
  MIEN_TRY(const auto source, open_encoder(config.encoder, config.options.spec_augment));
  said::Sizes sizes;
  sizes.width = config.width;
  sizes.time = sizes.inner = 4 * config.width;
  sizes.speech = source.config.hidden_size;
  sizes.has_projection = config.projection > 0;
  sizes.context = sizes.has_projection ? config.projection : sizes.speech;
  sizes.is_aligned = config.has_alignment_bias;
  run.description = describe(config, sizes, source.config);
  run.network.reset(new SaidNetwork{SpeechEncoder<Tensor>(source.config), said::Network<Tensor>(sizes)});
  initialise_as_published(*run.network, config.options.seed);
  MIEN_TRY([[maybe_unused]] const auto loaded, source.load_into(run.network->encoder));
  for (const auto& e : parameters(*run.network)) *e.slot = e.slot->detach().to(config.options.device);
  MIEN_TRY(run.learning, freeze(parameters(*run.network), config.frozen));
  return run;
}

Result<CoefficientData> read_data(const SaidConfig& config, ConsoleProgress& progress) {
  if (is_corpus(config.run.data))
    return read_corpus_coefficients(config.run.data, config.corpus, /*hears=*/true, progress);
  const auto sound_of = [&](const CoefficientFile& file) {
    const auto folder = config.sound.empty() ? file.path.parent_path() : config.sound / file.person;
    return (folder / file.path.stem()).replace_extension(".wav");
  };
  return read_coefficient_data(config.run.data, sound_of, progress);
}

Status write_model(SaidRun& run, const std::filesystem::path& path) {
  return save_parameters(parameters(*run.network), path, false, to_metadata(run.description));
}

}  // namespace

Status train_said(const SaidConfig& config, ConsoleProgress& progress) {
  MIEN_TRY(SaidRun run, prepare(config));
  MIEN_TRY(CoefficientData data, read_data(config, progress));
  SaidTrainingOptions options = config.options;
  if (!config.deviation.empty()) {
    MIEN_TRY(options.deviation, read_deviation(config.deviation));
  }
  MIEN_TRY([[maybe_unused]] const auto begun, config.run.begin());
  progress.say(std::to_string(data.train.size()) + " sequences to learn from, " +
               std::to_string(data.valid.size()) + " to validate");

  SaidStage stage(*run.network, std::move(data.train), mirror_order(arkit_order(ArkitOrder::said)), options);
  const std::int64_t epoch_steps = stage.steps_per_epoch();
  auto how = StageOptions::warm_adamw(config.num_epochs * epoch_steps, config.learning_rate,
                                      config.warm_up_epochs * epoch_steps, config.average_decay);
  how.checkpoint_every = config.checkpoint_every;
  const auto end_epoch = [&](std::int64_t epoch) -> Status {
    const auto is_due = [&](std::int64_t every) { return every > 0 && (epoch + 1) % every == 0; };
    if (is_due(config.validate_every) && !data.valid.empty()) {
      MIEN_TRY(const double valid,
               stage.validation_loss(data.valid, config.validation_passes,
                                     hash_combine(config.options.seed, static_cast<std::uint64_t>(epoch))));
      progress.say("epoch " + std::to_string(epoch) + ": validation loss " +
                   shortest(static_cast<float>(valid)));
    }
    if (is_due(config.export_every) && epoch + 1 < config.num_epochs)
      return write_model(run, config.run.work_folder / ("epoch_" + std::to_string(epoch) + ".safetensors"));
    return Done{};
  };
  MIEN_TRY([[maybe_unused]] const auto done,
           run_epochs(config.run,
                      {run.learning, how, epoch_steps, [&](std::int64_t step) { return stage.loss(step); },
                       end_epoch},
                      progress));
  MIEN_TRY([[maybe_unused]] const auto saved, write_model(run, config.run.output));
  progress.say("wrote " + config.run.output.string());
  return Done{};
}

Status snapshot_said(const SaidConfig& config, const std::filesystem::path& path, ConsoleProgress& progress) {
  MIEN_TRY(SaidRun run, prepare(config));
  MIEN_TRY(const auto step, load_stage_average(run.learning, config.run.checkpoint()));
  progress.say("checkpoint of step " + std::to_string(step));
  return write_model(run, path);
}

}  // namespace mien::train
