#include <algorithm>
#include <cmath>

#include "mien/base/number_text.h"
#include "mien/core/arkit.h"
#include "mien/datasets/coefficient_folder.h"
#include "mien/models/model_file.h"
#include "mien/train/coefficient_window.h"
#include "programs.h"
#include "step_reporter.h"

namespace mien::train {
namespace {

using torch::Tensor;

/// Sequences to learn from, and others to look at.
struct VaeData {
  std::vector<CoefficientSequence> train, valid;
};

// VOCASET's speakers by their split; of other persons, everything is learnt from.
Result<VaeData> read_data(const SaidVaeConfig& config, ConsoleProgress& progress) {
  const auto files = list_coefficients(config.run.data);
  if (!files) return files.error();
  for (const auto& warning : files.warnings) progress.warn(warning);
  const bool knows_speakers = std::ranges::any_of(
      *files, [](const CoefficientFile& f) { return coefficient_split(f.person) == "train"; });
  VaeData data;
  progress.stage("sequences", static_cast<std::int64_t>(files->size()));
  std::int64_t done = 0;
  for (const auto& file : *files) {
    if (progress.cancelled()) return Error{Errc::cancelled, "", "interrupted", ""};
    progress.update(++done);
    const auto split = knows_speakers ? coefficient_split(file.person) : "train";
    if (split != "train" && split != "val") continue;
    MIEN_TRY(Motion motion, read_coefficients(file.path));
    if (motion.num_frames() == 0) continue;
    (split == "train" ? data.train : data.valid).push_back({file.path.string(), std::move(motion.values)});
  }
  if (data.train.empty())
    return Error{Errc::incompatible, "'" + config.run.data.string() + "'", "has no frame to learn from", ""};
  return data;
}

Result<std::vector<float>> read_deviation(const SaidVaeConfig& config, const VaeData& data) {
  const auto width = static_cast<std::size_t>(config.sizes.channels);
  std::vector<float> deviation(width);
  std::string place = "the training sequences";
  if (!config.deviation.empty()) {
    place = "'" + config.deviation.string() + "'";
    MIEN_TRY(const Motion row, read_coefficients(config.deviation));
    if (row.num_frames() != 1)
      return Error{Errc::incompatible, place,
                   "has " + std::to_string(row.num_frames()) + " rows of deviations, not one", ""};
    std::ranges::copy(row.values, deviation.begin());
  } else {
    std::vector<double> sum(width), squares(width);
    double count = 0;
    for (const auto& s : data.train)
      for (std::size_t i = 0; i < s.values.size(); ++i) {
        const auto value = static_cast<double>(s.values[i]);
        sum[i % width] += value, squares[i % width] += value * value;
        count += i % width == 0 ? 1 : 0;
      }
    for (std::size_t k = 0; k < width; ++k) {
      const double mean = sum[k] / count;
      deviation[k] = static_cast<float>(std::sqrt(std::max(0.0, squares[k] / count - mean * mean)));
    }
  }
  for (std::size_t k = 0; k < width; ++k)
    if (!(deviation[k] > 0) || !std::isfinite(deviation[k]))
      return Error{
          Errc::incompatible, "the deviation of '" + arkit_order(ArkitOrder::said)[k] + "'",
          "is " + shortest(deviation[k]) + " in " + place,
          "Name a file of deviations in [run] deviation, or set [training] divide_by_deviation = false"};
  return deviation;
}

Status write_codec(said::Vae<Tensor>& vae, const SaidVaeConfig& config, const std::filesystem::path& path) {
  ModelFile m;
  m.architecture = Architecture::said_vae;
  m.name = config.run.name.empty() ? config.run.system : config.run.name;
  m.output = {.space = "arkit", .channels = config.sizes.channels, .fps = kCoefficientFps, .topology = ""};
  m.licence = "that of the coefficients it was trained on";
  m.training_config = config.run.text;
  m.training_set = "{\"layout\": \"coefficients\"}";
  return save_parameters(parameters(vae), path, false, to_metadata(m));
}

void prepare(said::Vae<Tensor>& vae, const SaidVaeConfig& config) {
  initialise_as_pytorch(vae, config.options.seed);
  for (const auto& e : parameters(vae)) *e.slot = e.slot->detach().to(config.options.device);
}

std::filesystem::path checkpoint_of(const SaidVaeConfig& config) {
  return config.run.work_folder / "checkpoint.safetensors";
}

}  // namespace

Status train_said_vae(const SaidVaeConfig& config, ConsoleProgress& progress) {
  torch::set_num_threads(config.run.num_threads);
  MIEN_TRY(VaeData data, read_data(config, progress));
  VaeTrainingOptions options = config.options;
  if (config.divides) {
    MIEN_TRY(options.deviation, read_deviation(config, data));
  }
  std::error_code ec;
  std::filesystem::create_directories(config.run.work_folder, ec);
  if (ec)
    return Error{Errc::failed, config.run.work_folder.string(), "cannot be created: " + ec.message(), ""};
  progress.say(std::to_string(data.train.size()) + " sequences to learn from, " +
               std::to_string(data.valid.size()) + " to validate");

  said::Vae<Tensor> vae(config.sizes);
  prepare(vae, config);
  const auto names = arkit_order(ArkitOrder::said);
  const std::vector<std::string_view> views(names.begin(), names.end());
  VaeStage stage(vae, std::move(data.train), mirror_order(views), options);
  const std::int64_t num_steps = stage.num_steps();
  auto how = StageOptions::warm_adamw(
      num_steps, config.learning_rate,
      static_cast<std::int64_t>(config.warm_up_share * static_cast<double>(num_steps)), config.average_decay);
  how.checkpoint_every = config.checkpoint_every;
  how.keeps_buffers = true;
  StepReporter log(config.run.work_folder / "log.tsv", progress);
  log.begin(config.run.system);
  const auto report = [&](const StepReport& r) {
    log(r);
    const std::int64_t every = config.validate_every * stage.steps_per_epoch();
    if (data.valid.empty() || (r.step + 1) % every != 0) return;
    progress.say("epoch " + std::to_string(r.step / stage.steps_per_epoch()) +
                 ": reconstruction error of windows " +
                 shortest(static_cast<float>(stage.reconstruction_error(data.valid))));
  };
  MIEN_TRY([[maybe_unused]] const auto done,
           run_stage(
               config.run.system, parameters(vae), how, checkpoint_of(config),
               [&](std::int64_t step) -> Result<Tensor> { return stage.loss(step); }, progress, report));
  MIEN_TRY([[maybe_unused]] const auto saved, write_codec(vae, config, config.run.output));
  progress.say("wrote " + config.run.output.string());
  return Done{};
}

Status snapshot_said_vae(const SaidVaeConfig& config, const std::filesystem::path& path,
                         ConsoleProgress& progress) {
  said::Vae<Tensor> vae(config.sizes);
  prepare(vae, config);
  MIEN_TRY(const auto step, load_stage_average(parameters(vae), checkpoint_of(config)));
  progress.say("checkpoint of step " + std::to_string(step));
  return write_codec(vae, config, path);
}

}  // namespace mien::train
