#pragma once
#include <functional>
#include <vector>

#include "mien/console/console_exit.h"
#include "mien/train/optimiser.h"
#include "training_config.h"

namespace mien::train {

/// How a published system is trained: one stage in epochs, with a log and a checkpoint in the work folder.
struct EpochRun {
  std::vector<Collect::Entry> learning;  ///< and buffers, where they belong to the checkpoint
  StageOptions options;
  std::int64_t steps_per_epoch = 1;
  std::function<Result<torch::Tensor>(std::int64_t step)> loss;
  /// After each epoch, while the parameters hold their average: validates, writes.
  std::function<Status(std::int64_t epoch)> end_epoch;
  /// Asked before each step: nothing more is to be learnt. Absent: all steps are done.
  std::function<bool()> is_over{};
};

/// Runs all epochs, from the checkpoint on where there is one. Errors: those of run_stage(), of the loss and
/// of end_epoch.
Status run_epochs(const RunConfig& run, const EpochRun& epochs, ConsoleProgress& progress);

}  // namespace mien::train
