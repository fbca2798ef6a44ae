#pragma once
#include "mien/base/number_text.h"
#include "mien/console/console_exit.h"
#include "mien/train/optimiser.h"
#include "step_log.h"

namespace mien::train {

/// Each step in the log, and the loss behind the progress bar.
class StepReporter {
 public:
  StepReporter(const std::filesystem::path& path, ConsoleProgress& progress)
      : log_(path), progress_(progress) {}

  void begin(std::string stage) { log_.begin(std::move(stage)), smooth_ = -1; }
  void operator()(const StepReport& r) {
    smooth_ = smooth_ < 0 ? r.loss : 0.98 * smooth_ + 0.02 * r.loss;
    progress_.note("loss " + fixed(smooth_, 6));
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

}  // namespace mien::train
