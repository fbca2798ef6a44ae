#include "corpus_coefficients.h"
#include "epoch_run.h"
#include "mien/base/number_text.h"
#include "mien/core/arkit.h"
#include "mien/corpus/corpus_reader.h"
#include "mien/models/model_file.h"
#include "programs.h"

namespace mien::train {
namespace {

using torch::Tensor;

// What differences are divided by; empty: nothing.
Result<std::vector<float>> deviation_for(const SaidVaeConfig& config, const CoefficientData& data) {
  if (!config.divides) return std::vector<float>();
  return config.deviation.empty() ? measure_deviation(data.train) : read_deviation(config.deviation);
}

Status write_codec(said::Vae<Tensor>& vae, const SaidVaeConfig& config, const std::filesystem::path& path) {
  ModelFile m;
  m.architecture = Architecture::said_vae;
  m.name = config.run.name.empty() ? config.run.system : config.run.name;
  m.output = {.space = "arkit", .channels = config.sizes.channels, .fps = kCoefficientFps, .topology = ""};
  m.licence = "that of the coefficients it was trained on";
  m.training_config = config.run.text;
  m.training_set = is_corpus(config.run.data) ? "{\"layout\": \"corpus\"}" : "{\"layout\": \"coefficients\"}";
  return save_parameters(parameters(vae), path, false, to_metadata(m));
}

void prepare(said::Vae<Tensor>& vae, const SaidVaeConfig& config) {
  initialise_as_pytorch(vae, config.options.seed);
  for (const auto& e : parameters(vae)) *e.slot = e.slot->detach().to(config.options.device);
}

}  // namespace

Status train_said_vae(const SaidVaeConfig& config, ConsoleProgress& progress) {
  MIEN_TRY(CoefficientData data,
           is_corpus(config.run.data)
               ? read_corpus_coefficients(config.run.data, config.corpus, false, progress)
               : read_coefficient_data(config.run.data, {}, progress));
  VaeTrainingOptions options = config.options;
  MIEN_TRY(options.deviation, deviation_for(config, data));
  MIEN_TRY([[maybe_unused]] const auto begun, config.run.begin());
  progress.say(std::to_string(data.train.size()) + " sequences to learn from, " +
               std::to_string(data.valid.size()) + " to validate");

  said::Vae<Tensor> vae(config.sizes);
  prepare(vae, config);
  VaeStage stage(vae, std::move(data.train), mirror_order(arkit_order(ArkitOrder::said)), options);
  const std::int64_t num_steps = stage.num_steps();
  auto how = StageOptions::warm_adamw(
      num_steps, config.learning_rate,
      static_cast<std::int64_t>(config.warm_up_share * static_cast<double>(num_steps)), config.average_decay);
  how.checkpoint_every = config.checkpoint_every;
  how.keeps_buffers = true;
  const auto end_epoch = [&](std::int64_t epoch) -> Status {
    if (!data.valid.empty() && (epoch + 1) % config.validate_every == 0)
      progress.say("epoch " + std::to_string(epoch) + ": reconstruction error of windows " +
                   shortest(static_cast<float>(stage.reconstruction_error(data.valid))));
    return Done{};
  };
  MIEN_TRY([[maybe_unused]] const auto done,
           run_epochs(config.run,
                      {parameters(vae), how, stage.steps_per_epoch(),
                       [&](std::int64_t step) { return stage.loss(step); }, end_epoch},
                      progress));
  MIEN_TRY([[maybe_unused]] const auto saved, write_codec(vae, config, config.run.output));
  progress.say("wrote " + config.run.output.string());
  return Done{};
}

Status snapshot_said_vae(const SaidVaeConfig& config, const std::filesystem::path& path,
                         ConsoleProgress& progress) {
  said::Vae<Tensor> vae(config.sizes);
  prepare(vae, config);
  MIEN_TRY(const auto step, load_stage_average(parameters(vae), config.run.checkpoint()));
  progress.say("checkpoint of step " + std::to_string(step));
  return write_codec(vae, config, path);
}

}  // namespace mien::train
