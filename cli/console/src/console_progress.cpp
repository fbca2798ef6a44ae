#include "mien/console/console_progress.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include "mien/base/number_text.h"
#include "mien/console/console_exit.h"

namespace mien {
namespace {

std::string time_text(double seconds) {
  const auto s = static_cast<std::int64_t>(seconds + 0.5);
  const auto two = [](std::int64_t v) { return (v < 10 ? "0" : "") + std::to_string(v); };
  if (s < 3600) return std::to_string(s / 60) + ":" + two(s % 60);
  return std::to_string(s / 3600) + ":" + two(s / 60 % 60) + ":" + two(s % 60);
}

}  // namespace

ConsoleProgress::ConsoleProgress(ConsoleMode mode) : mode_(mode), is_terminal_(::isatty(2) == 1) {}
ConsoleProgress::~ConsoleProgress() { finish_line(); }

void ConsoleProgress::stage(std::string_view name, std::int64_t total) {
  finish_line();
  stage_ = name;
  total_ = total;
  done_ = 0;
  first_done_ = -1;
  stage_start_ = Clock::now();
  last_draw_ = is_terminal_ ? Clock::time_point{} : stage_start_;
  note_.clear();
}

void ConsoleProgress::update(std::int64_t done) {
  if (first_done_ < 0) first_done_ = done - 1;  // resumed work does not start at zero
  done_ = done;
  const auto interval = is_terminal_ && mode_ == ConsoleMode::text ? std::chrono::milliseconds(100)
                        : mode_ == ConsoleMode::json               ? std::chrono::milliseconds(500)
                                                                   : std::chrono::milliseconds(10000);
  const auto now = Clock::now();
  if (now - last_draw_ < interval && done != total_) return;
  if (now - stage_start_ < std::chrono::milliseconds(300)) return;  // short stages need no bar
  last_draw_ = now;
  draw();
}

void ConsoleProgress::draw() {
  if (mode_ == ConsoleMode::quiet) return;
  const double elapsed = std::chrono::duration<double>(Clock::now() - stage_start_).count();
  const double fraction = total_ > 0 ? static_cast<double>(done_) / static_cast<double>(total_) : 0;
  const auto fresh = static_cast<double>(std::max<std::int64_t>(1, done_ - first_done_));
  const double left = total_ > 0 ? elapsed / fresh * static_cast<double>(total_ - done_) : 0;
  if (mode_ == ConsoleMode::json) {
    event("progress", "\"stage\":" + json_string(stage_) + ",\"done\":" + std::to_string(done_) +
                          ",\"total\":" + std::to_string(total_) + ",\"seconds_left\":" + fixed(left, 1));
    return;
  }
  std::string line = stage_;
  if (total_ > 0) {
    constexpr int kWidth = 24;
    const auto filled = static_cast<std::size_t>(fraction * kWidth);
    line += " [" + std::string(filled, '#') + std::string(kWidth - filled, ' ') + "] " +
            std::to_string(static_cast<int>(fraction * 100)) + " %, " + time_text(left) + " left";
  } else {
    line += " " + std::to_string(done_);
  }
  if (!note_.empty()) line += "  " + note_;
  if (is_terminal_) {
    std::fprintf(stderr, "\r\033[K%s", line.c_str());
    line_open_ = true;
    if (done_ == total_) finish_line();
  } else {
    std::fprintf(stderr, "%s\n", line.c_str());
  }
  std::fflush(stderr);
}

void ConsoleProgress::finish_line() {
  if (line_open_) std::fputc('\n', stderr);
  line_open_ = false;
}

void ConsoleProgress::warn(std::string_view message) {
  if (mode_ == ConsoleMode::json) return event("warning", "\"message\":" + json_string(message));
  if (mode_ == ConsoleMode::quiet) return;
  finish_line();
  std::fprintf(stderr, "warning: %.*s\n", static_cast<int>(message.size()), message.data());
}

void ConsoleProgress::say(std::string_view message) {
  if (mode_ != ConsoleMode::text) return;
  finish_line();
  std::fprintf(stderr, "%.*s\n", static_cast<int>(message.size()), message.data());
}

void ConsoleProgress::event(std::string_view type, std::string_view fields) {
  if (mode_ != ConsoleMode::json) return;
  std::string line = "{\"mien\":1,\"type\":" + json_string(type);
  if (!fields.empty()) line += "," + std::string(fields);
  std::fprintf(stderr, "%s}\n", line.c_str());
  std::fflush(stderr);
}

}  // namespace mien
