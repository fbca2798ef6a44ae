#pragma once
#include <chrono>
#include <string>

#include "mien/base/progress.h"

namespace mien {

/// Progress on stderr: one line that is redrawn on a terminal; whole lines, at most one every ten seconds,
/// elsewhere.
class ConsoleProgress final : public Progress {
 public:
  explicit ConsoleProgress(bool quiet);
  ~ConsoleProgress() override;
  void stage(std::string_view name, std::int64_t total) override;
  void update(std::int64_t done) override;
  void warn(std::string_view message) override;

 private:
  void end_line();
  bool quiet_, terminal_, line_open_ = false;
  std::string name_;
  std::int64_t total_ = 0;
  std::chrono::steady_clock::time_point started_, drawn_;
};

}  // namespace mien
