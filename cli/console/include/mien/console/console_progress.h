#pragma once
#include <chrono>
#include <cstdint>
#include <string>

#include "mien/base/progress.h"

namespace mien {

/// How a program speaks on stderr.
enum class ConsoleMode {
  text,   ///< a progress bar when stderr is a terminal, plain warnings
  quiet,  ///< errors only
  json,   ///< one JSON object a line: start, progress, warning, success, failure (docs/formats.md)
};

/// Progress of long work on stderr: stage, percent, time left. In text mode a bar is drawn on a terminal;
/// elsewhere a line is printed every ten seconds.
class ConsoleProgress : public Progress {
 public:
  explicit ConsoleProgress(ConsoleMode mode);
  ~ConsoleProgress() override;
  void stage(std::string_view name, std::int64_t total) override;
  void update(std::int64_t done) override;
  void warn(std::string_view message) override;

  /// Extra text behind the bar, e.g. the loss.
  void note(std::string text) { note_ = std::move(text); }
  /// A line of result or information (text mode only).
  void say(std::string_view message);
  /// One JSON line (json mode only): `fields` is the inside of an object, e.g. "\"output\":\"a.glb\"".
  void event(std::string_view type, std::string_view fields);
  [[nodiscard]] ConsoleMode mode() const { return mode_; }
  /// Ends the current line of the bar.
  void finish_line();

 private:
  using Clock = std::chrono::steady_clock;
  void draw();

  ConsoleMode mode_;
  bool is_terminal_;
  bool line_open_ = false;
  std::string stage_, note_;
  std::int64_t total_ = 0, done_ = 0, first_done_ = -1;
  Clock::time_point stage_start_{}, last_draw_{};
};

}  // namespace mien
