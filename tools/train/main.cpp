// mien-train: trains a model as a configuration file says. `mien train` calls it.
#include <CLI/CLI.hpp>
#include <functional>

#include "programs.h"

namespace mien::train {
namespace {

Status run_config(const std::string& path, const std::string& snapshot,
                  const std::function<void(RunConfig&)>& change, ConsoleProgress& progress) {
  MIEN_TRY(TomlFile file, TomlFile::open(path));
  std::string system = "default";
  file.read("run", "system", system);
  const auto run = [&](auto config, auto train, auto write_snapshot) -> Status {
    if (!config) return config.error();
    change(config->run);
    config->options.device = config->run.device;
    return snapshot.empty() ? train(*config, progress) : write_snapshot(*config, snapshot, progress);
  };
  if (system == "default") return run(read_training_config(file), train_default, snapshot_default);
  if (system == architecture_name(Architecture::said))
    return run(read_said_config(file), train_said, snapshot_said);
  if (system == architecture_name(Architecture::said_vae))
    return run(read_said_vae_config(file), train_said_vae, snapshot_said_vae);
  if (system == architecture_name(Architecture::probtalk3d_prior))
    return run(read_probtalk3d_prior_config(file), train_probtalk3d_prior, snapshot_probtalk3d_prior);
  if (system == architecture_name(Architecture::probtalk3d))
    return run(read_probtalk3d_config(file), train_probtalk3d, snapshot_probtalk3d);
  for (const auto architecture :
       {Architecture::facexhubert, Architecture::facediffuser_v, Architecture::facediffuser_beat,
        Architecture::facediffuser_damm, Architecture::facediffuser_emotion})
    if (system == architecture_name(architecture))
      return run(read_face_config(file, architecture), train_face, snapshot_face);
  return Error{Errc::usage, "'" + path + "'", "[run] system '" + system + "' is not known",
               "Known: default, facexhubert, facediffuser_v, facediffuser_beat, facediffuser_damm, "
               "facediffuser_emotion, probtalk3d_prior, probtalk3d, said, said_vae"};
}

}  // namespace
}  // namespace mien::train

int main(int argc, char** argv) {
  using namespace mien;
  CLI::App app{"Train a model. Runs again after an interruption go on from the last checkpoint.",
               "mien train"};
  std::string config_path, data, output, work_folder, snapshot_path, device = "cpu";
  int threads = 0;
  bool quiet = false, json = false;
  app.add_option("CONFIG", config_path, "Training configuration (TOML)")->required();
  app.add_option("--data", data, "Prepared set, or folder of a data set or a corpus; replaces [run] data");
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
      "  mien train configs/facexhubert.toml --data BIWI -o facexhubert.safetensors\n"
      "  mien train configs/probtalk3d_prior.toml --data 3DMEAD && mien train configs/probtalk3d.toml --data "
      "3DMEAD\n"
      "Exit codes: 0 done, 1 failed, 2 wrong usage, 3 unreadable input, 4 data do not fit, 130 interrupted.");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  }
  ConsoleProgress progress(json ? ConsoleMode::json : quiet ? ConsoleMode::quiet : ConsoleMode::text);
  cancel_on_interrupt(progress);
  if (device == "cuda" && !torch::cuda::is_available())
    return report_error(
        {Errc::usage, "--device cuda", "this LibTorch finds no CUDA device", "Use --device cpu"}, progress);
  const auto change = [&](train::RunConfig& run) {
    if (!data.empty()) run.data = data;
    if (!output.empty()) run.output = output;
    if (!work_folder.empty()) run.work_folder = work_folder;
    if (threads > 0) run.num_threads = threads;
    if (device == "cuda") run.device = torch::kCUDA;
  };
  const auto done = train::run_config(config_path, snapshot_path, change, progress);
  return done ? 0 : report_error(done.error(), progress);
}
