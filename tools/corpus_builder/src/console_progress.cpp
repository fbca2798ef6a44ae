#include "console_progress.h"

#include <unistd.h>

#include <cstdio>

namespace mien {

ConsoleProgress::ConsoleProgress(bool quiet) : quiet_(quiet), terminal_(::isatty(STDERR_FILENO) == 1) {}
ConsoleProgress::~ConsoleProgress() { end_line(); }

void ConsoleProgress::end_line() {
  if (line_open_) std::fputc('\n', stderr);
  line_open_ = false;
}

void ConsoleProgress::stage(std::string_view name, std::int64_t total) {
  end_line();
  name_ = name;
  total_ = total;
  started_ = drawn_ = std::chrono::steady_clock::now();
  if (!quiet_) std::fprintf(stderr, "%s ...\n", name_.c_str());
}

void ConsoleProgress::update(std::int64_t done) {
  using namespace std::chrono;
  const auto now = steady_clock::now();
  const bool last = done == total_;
  if (quiet_ || (!last && now - drawn_ < (terminal_ ? milliseconds(200) : milliseconds(10000)))) return;
  drawn_ = now;
  const double spent = duration<double>(now - started_).count();
  const double left = done > 0 ? spent * static_cast<double>(total_ - done) / static_cast<double>(done) : 0;
  std::fprintf(stderr, "%s%s %lld of %lld (%.0f %%), %.0f s spent, %.0f s left%s", terminal_ ? "\r" : "",
               name_.c_str(), static_cast<long long>(done), static_cast<long long>(total_),
               total_ > 0 ? 100.0 * static_cast<double>(done) / static_cast<double>(total_) : 0.0, spent,
               left, terminal_ ? "   " : "\n");
  line_open_ = terminal_;
}

void ConsoleProgress::warn(std::string_view message) {
  end_line();
  if (!quiet_) std::fprintf(stderr, "warning: %.*s\n", static_cast<int>(message.size()), message.data());
}

}  // namespace mien
