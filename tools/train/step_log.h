#pragma once
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

#include "mien/base/result.h"

namespace mien::train {

/// The log of a run: stage, step, loss, learning rate and gradient norm, tab-separated, a line a step. Each
/// line is in the file before the step's checkpoint is, and steps that a run does again replace those of the
/// run that was killed: whatever happened on the way, the file at the end is that of a run without
/// interruption.
class StepLog {
 public:
  explicit StepLog(std::filesystem::path path) : path_(std::move(path)) {}
  /// The lines that follow belong to this stage. Stages come in the same order in every run.
  void begin(std::string stage);
  /// Errors (Errc::failed): the file cannot be written.
  Status add(std::int64_t step, double loss, double learning_rate, double gradient_norm);

 private:
  // Cuts the file before the first line of `stage_` at or after the step, or before a line without an end.
  Status forget_from(std::int64_t step);

  std::filesystem::path path_;
  std::ofstream file_;  // open from the first step of a stage on
  std::string stage_;
};

}  // namespace mien::train
