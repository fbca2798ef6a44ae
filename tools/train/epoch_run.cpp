#include "epoch_run.h"

#include "step_reporter.h"

namespace mien::train {

Status run_epochs(const RunConfig& run, const EpochRun& epochs, ConsoleProgress& progress) {
  StepReporter log(run.work_folder / "log.tsv", progress);
  log.begin(run.system);
  Status afterwards = Done{};  // of what is done after epochs
  const auto report = [&](const StepReport& r) {
    log(r);
    if ((r.step + 1) % epochs.steps_per_epoch != 0) return;
    r.with_average([&] {
      const auto ended = epochs.end_epoch(r.step / epochs.steps_per_epoch);
      if (!ended) afterwards = ended.error();
    });
  };
  const auto loss = [&](std::int64_t step) -> Result<torch::Tensor> {
    if (!afterwards) return afterwards.error();
    if (epochs.is_over && epochs.is_over()) return torch::Tensor();
    return epochs.loss(step);
  };
  MIEN_TRY([[maybe_unused]] const auto done,
           run_stage(run.system, epochs.learning, epochs.options, run.checkpoint(), loss, progress, report));
  return afterwards;
}

}  // namespace mien::train
