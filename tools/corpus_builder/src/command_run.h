#pragma once
#include <cstdint>

#include "console_progress.h"
#include "mien/base/error.h"

namespace mien {

/// Prints the error and gives the exit code of its class.
int report(const Error& error);

/// Progress on stderr that Ctrl-C cancels, so that no half file is left. One at a time.
class InterruptibleProgress {
 public:
  explicit InterruptibleProgress(bool quiet);
  InterruptibleProgress(const InterruptibleProgress&) = delete;
  InterruptibleProgress& operator=(const InterruptibleProgress&) = delete;
  ~InterruptibleProgress();
  [[nodiscard]] Progress& get() { return progress_; }

 private:
  ConsoleProgress progress_;
};

}  // namespace mien
