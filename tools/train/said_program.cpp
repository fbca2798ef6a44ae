#include <algorithm>
#include <cmath>

#include "mien/audio/load_audio.h"
#include "mien/base/hash.h"
#include "mien/base/number_text.h"
#include "mien/core/arkit.h"
#include "mien/datasets/coefficient_folder.h"
#include "mien/models/model_file.h"
#include "mien/train/coefficient_window.h"
#include "mien/train/encoder_training.h"
#include "programs.h"
#include "step_reporter.h"

namespace mien::train {
namespace {

using torch::Tensor;

/// Sequences to learn from, and others to look at.
struct SaidData {
  std::vector<SaidSequence> train, valid;
};

std::filesystem::path sound_of(const SaidConfig& config, const CoefficientFile& file) {
  const std::filesystem::path folder =
      config.sound.empty() ? file.path.parent_path() : config.sound / file.person;
  return (folder / file.path.stem()).replace_extension(".wav");
}

// VOCASET's speakers by their split; of other persons, everything is learnt from. Sentences without sound are
// left out, as in the authors' program.
Result<SaidData> read_data(const SaidConfig& config, ConsoleProgress& progress) {
  const auto files = list_coefficients(config.run.data);
  if (!files) return files.error();
  for (const auto& warning : files.warnings) progress.warn(warning);
  const bool knows_speakers = std::ranges::any_of(
      *files, [](const CoefficientFile& f) { return coefficient_split(f.person) == "train"; });
  SaidData data;
  progress.stage("sequences", static_cast<std::int64_t>(files->size()));
  std::int64_t done = 0, num_silent = 0;
  for (const auto& file : *files) {
    if (progress.cancelled()) return Error{Errc::cancelled, "", "interrupted", ""};
    progress.update(++done);
    const auto split = knows_speakers ? coefficient_split(file.person) : "train";
    if (split != "train" && split != "val") continue;
    if (!std::filesystem::exists(sound_of(config, file))) {
      ++num_silent;
      continue;
    }
    MIEN_TRY(Motion motion, read_coefficients(file.path));
    MIEN_TRY(AudioClip clip, load_audio(sound_of(config, file)));
    if (motion.num_frames() == 0 || clip.samples.empty()) continue;
    (split == "train" ? data.train : data.valid)
        .push_back({file.path.string(), std::move(clip.samples), std::move(motion.values)});
  }
  if (num_silent > 0)
    progress.warn(std::to_string(num_silent) + " sequences have no sound and are left out, for example '" +
                  sound_of(config, files->front()).string() + "'");
  if (data.train.empty())
    return Error{Errc::incompatible, "'" + config.run.data.string() + "'",
                 "has no sequence with sound to learn from",
                 "Expected is <person>/sentenceNN.wav beside the coefficients or in [run] sound"};
  return data;
}

Result<std::vector<float>> read_deviation(const SaidConfig& config) {
  if (config.deviation.empty()) return std::vector<float>();
  const std::string place = "'" + config.deviation.string() + "'";
  MIEN_TRY(const Motion row, read_coefficients(config.deviation));
  if (row.num_frames() != 1)
    return Error{Errc::incompatible, place,
                 "has " + std::to_string(row.num_frames()) + " rows of deviations, not one", ""};
  for (std::size_t k = 0; k < row.values.size(); ++k)
    if (!(row.values[k] > 0) || !std::isfinite(row.values[k]))
      return Error{Errc::incompatible, "the deviation of '" + row.channels[k] + "'",
                   "is " + shortest(row.values[k]) + " in " + place, ""};
  return row.values;
}

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
  m.training_set = "{\"layout\": \"coefficients\"}";
  return m;
}

Result<SaidRun> prepare(const SaidConfig& config) {
  SaidRun run;
  MIEN_TRY(const auto file, SafetensorsFile::open(config.encoder));
  const std::string name = "'" + config.encoder.string() + "'";
  const auto source = read_model_file(file.metadata());
  if (!source) return within(source.error(), name);
  if (!source->encoder)
    return Error{Errc::incompatible, name, "holds no speech encoder",
                 "Make one: mien import WAV2VEC2-FOLDER"};
  if (config.options.spec_augment && source->encoder->mask_feature_prob > 0)
    return Error{Errc::incompatible, name, "masks features in training, which Mien does not",
                 "Set [random] spec_augment = false"};
  said::Sizes sizes;
  sizes.width = config.width;
  sizes.time = sizes.inner = 4 * config.width;
  sizes.speech = source->encoder->hidden_size;
  sizes.has_projection = config.projection > 0;
  sizes.context = sizes.has_projection ? config.projection : sizes.speech;
  sizes.is_aligned = config.has_alignment_bias;
  run.description = describe(config, sizes, *source->encoder);
  run.network.reset(new SaidNetwork{SpeechEncoder<Tensor>(*source->encoder), said::Network<Tensor>(sizes)});
  initialise_as_published(*run.network, config.options.seed);
  const auto loaded = load_encoder(run.network->encoder, file);
  if (!loaded) return within(loaded.error(), name);
  for (const auto& e : parameters(*run.network)) *e.slot = e.slot->detach().to(config.options.device);
  MIEN_TRY(run.learning, freeze(parameters(*run.network), config.frozen));
  return run;
}

std::filesystem::path checkpoint_of(const SaidConfig& config) {
  return config.run.work_folder / "checkpoint.safetensors";
}

Status write_model(SaidRun& run, const std::filesystem::path& path) {
  return save_parameters(parameters(*run.network), path, false, to_metadata(run.description));
}

}  // namespace

Status train_said(const SaidConfig& config, ConsoleProgress& progress) {
  torch::set_num_threads(config.run.num_threads);
  MIEN_TRY(SaidRun run, prepare(config));
  MIEN_TRY(SaidData data, read_data(config, progress));
  SaidTrainingOptions options = config.options;
  MIEN_TRY(options.deviation, read_deviation(config));
  std::error_code ec;
  std::filesystem::create_directories(config.run.work_folder, ec);
  if (ec)
    return Error{Errc::failed, config.run.work_folder.string(), "cannot be created: " + ec.message(), ""};
  progress.say(std::to_string(data.train.size()) + " sequences to learn from, " +
               std::to_string(data.valid.size()) + " to validate");

  const auto names = arkit_order(ArkitOrder::said);
  const std::vector<std::string_view> views(names.begin(), names.end());
  SaidStage stage(*run.network, std::move(data.train), mirror_order(views), options);
  const std::int64_t epoch_steps = stage.steps_per_epoch();
  auto how = StageOptions::warm_adamw(config.num_epochs * epoch_steps, config.learning_rate,
                                      config.warm_up_epochs * epoch_steps, config.average_decay);
  how.checkpoint_every = config.checkpoint_every;
  StepReporter log(config.run.work_folder / "log.tsv", progress);
  log.begin(config.run.system);
  Status afterwards = Done{};  // of what is done after epochs, with the averaged weights
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
  const auto report = [&](const StepReport& r) {
    log(r);
    if ((r.step + 1) % epoch_steps != 0) return;
    r.with_average([&] {
      const auto ended = end_epoch(r.step / epoch_steps);
      if (!ended) afterwards = ended.error();
    });
  };
  const auto loss = [&](std::int64_t step) -> Result<Tensor> {
    if (!afterwards) return afterwards.error();
    return stage.loss(step);
  };
  MIEN_TRY([[maybe_unused]] const auto done,
           run_stage(config.run.system, run.learning, how, checkpoint_of(config), loss, progress, report));
  if (!afterwards) return afterwards;
  MIEN_TRY([[maybe_unused]] const auto saved, write_model(run, config.run.output));
  progress.say("wrote " + config.run.output.string());
  return Done{};
}

Status snapshot_said(const SaidConfig& config, const std::filesystem::path& path, ConsoleProgress& progress) {
  MIEN_TRY(SaidRun run, prepare(config));
  MIEN_TRY(const auto step, load_stage_average(run.learning, checkpoint_of(config)));
  progress.say("checkpoint of step " + std::to_string(step));
  return write_model(run, path);
}

}  // namespace mien::train
