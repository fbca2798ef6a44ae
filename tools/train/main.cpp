// mien-train: trains the default model from a prepared set. `mien train` calls it.
#include <CLI/CLI.hpp>

#include "mien/base/number_text.h"
#include "mien/console/console_exit.h"
#include "mien/models/default/model_metadata.h"
#include "step_log.h"
#include "training_config.h"

namespace mien::train {
namespace {

// Each step in the log, and the loss behind the progress bar.
class StepReporter {
 public:
  StepReporter(const std::filesystem::path& path, ConsoleProgress& progress)
      : log_(path), progress_(progress) {}

  void begin(std::string stage) { log_.begin(std::move(stage)), smooth_ = -1; }
  void operator()(const StepReport& r) {
    smooth_ = smooth_ < 0 ? r.loss : 0.98 * smooth_ + 0.02 * r.loss;
    progress_.note("loss " + fixed(smooth_, 4));
    const auto done = log_.add(r.step, r.loss, r.learning_rate, r.gradient_norm);
    if (!done && !is_log_lost_) progress_.warn(done.error().message());
    is_log_lost_ = !done;
  }

 private:
  StepLog log_;
  ConsoleProgress& progress_;
  double smooth_ = -1;
  bool is_log_lost_ = false;
};

Status export_model(const TrainingConfig& config, const TrainingSet& set, Network& network,
                    const std::filesystem::path& path) {
  default_model::ModelMetadata metadata;
  metadata.name = config.name;
  metadata.sizes = config.sizes;
  metadata.look_ahead_mel_frames = config.options.look_ahead_mel_frames;
  metadata.training_config = config.text;
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
  for (const auto& entry : parameters(network)) *entry.slot = entry.slot->detach().to(config.options.device);
  measure_face_statistics(set, network);
  return network;
}

// The model as far as it is: averaged weights of the last checkpoints, start values where there is none yet.
Status snapshot(const TrainingConfig& config, const std::filesystem::path& path, ConsoleProgress& progress) {
  MIEN_TRY(const auto set, TrainingSet::open(config.data));
  const WorkFiles files(config.work_folder);
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

Status train(const TrainingConfig& config, ConsoleProgress& progress) {
  torch::set_num_threads(config.num_threads);
  MIEN_TRY(const auto set, TrainingSet::open(config.data));
  std::error_code ec;
  std::filesystem::create_directories(config.work_folder, ec);
  if (ec) return Error{Errc::failed, config.work_folder.string(), "cannot be created: " + ec.message(), ""};
  const WorkFiles files(config.work_folder);
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

  MIEN_TRY([[maybe_unused]] const auto saved, export_model(config, set, network, config.output));
  progress.say("wrote " + config.output.string());
  return Done{};
}

}  // namespace
}  // namespace mien::train

int main(int argc, char** argv) {
  using namespace mien;
  CLI::App app{
      "Train a model from a prepared set. Runs again after an interruption go on from the last checkpoint.",
      "mien train"};
  std::string config_path, data, output, work_folder, snapshot_path, device = "cpu";
  int threads = 0;
  bool quiet = false, json = false;
  app.add_option("CONFIG", config_path, "Training configuration (TOML)")->required();
  app.add_option("--data", data, "Prepared set; replaces [run] data");
  app.add_option("-o,--output", output, "Model file to write; replaces [run] output");
  app.add_option("--work-folder", work_folder, "Checkpoints and log; replaces [run] work_folder");
  app.add_option("--threads", threads, "Threads; replaces [run] threads")->check(CLI::PositiveNumber);
  app.add_option("--device", device, "cpu or cuda")
      ->capture_default_str()
      ->check(CLI::IsMember({"cpu", "cuda"}));
  app.add_option("--snapshot", snapshot_path,
                 "Only write the model as far as it is trained to this file, and stop");
  app.add_flag("--quiet", quiet, "Print errors only");
  app.add_flag("--json", json, "One JSON event a line on stderr");
  app.footer(
      "Examples:\n"
      "  mien corpus prepare -o set.safetensors && mien train configs/default.toml\n"
      "  mien train configs/default.toml --data set.safetensors --device cuda -o model.safetensors\n"
      "Exit codes: 0 done, 1 failed, 2 wrong usage, 3 unreadable input, 4 data do not fit, 130 interrupted.");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  }
  ConsoleProgress progress(json ? ConsoleMode::json : quiet ? ConsoleMode::quiet : ConsoleMode::text);
  cancel_on_interrupt(progress);
  auto config = train::load_training_config(config_path);
  if (!config) return report_error(config.error(), progress);
  if (!data.empty()) config->data = data;
  if (!output.empty()) config->output = output;
  if (!work_folder.empty()) config->work_folder = work_folder;
  if (threads > 0) config->num_threads = threads;
  if (device == "cuda") {
    if (!torch::cuda::is_available())
      return report_error(
          {Errc::usage, "--device cuda", "this LibTorch finds no CUDA device", "Use --device cpu"}, progress);
    config->options.device = torch::kCUDA;
  }
  const auto done = snapshot_path.empty() ? train::train(*config, progress)
                                          : train::snapshot(*config, snapshot_path, progress);
  return done ? 0 : report_error(done.error(), progress);
}
