#pragma once
#include <functional>

#include "epoch_run.h"
#include "mien/train/early_stopping.h"
#include "mien/train/probtalk3d_training.h"

namespace mien::train {

/// When a training ends, and what it delivers.
struct StoppingFields {
  EarlyStopping::Monitor monitor = EarlyStopping::Monitor::running_mean;
  std::int64_t patience = 5;  ///< epochs; 0: all epochs are done
  bool keeps_best = false;    ///< deliver the weights of the least figure, not those of the last epoch
};
/// [training] monitor, patience and keep.
void read_stopping(TomlFile& file, StoppingFields& stopping);

/// A training that validates after each epoch and may end early.
struct StoppingRun {
  std::vector<Collect::Entry> learning;
  StageOptions options;
  std::int64_t steps_per_epoch = 1;
  bool has_validation = false;
  std::function<Result<torch::Tensor>(std::int64_t step)> loss;
  std::function<Result<probtalk3d::Validation>(std::int64_t epoch)> validate;
  std::function<Status(const std::filesystem::path& path)> write_model;
};

/// Runs it and writes the model to run.output, and that of the least figure to best.safetensors in the work
/// folder. Errors: those of run_epochs(); Errc::incompatible: it is to end early, but nothing validates.
Status run_until_stopped(const RunConfig& run, const StoppingFields& stopping, const StoppingRun& what,
                         ConsoleProgress& progress);

/// What such a run would deliver if it ended now, written to `path`: with keep = "best" the model of the
/// least figure so far, else that of the last checkpoint.
/// @param learning     of a network that `write_model` writes
/// Errors: no checkpoint; (Errc::input) keep = "best" and no epoch has been validated yet.
Status snapshot_of_stopped(const RunConfig& run, const StoppingFields& stopping,
                           std::vector<Collect::Entry> learning,
                           const std::function<Status(const std::filesystem::path& path)>& write_model,
                           const std::filesystem::path& path, ConsoleProgress& progress);

}  // namespace mien::train
