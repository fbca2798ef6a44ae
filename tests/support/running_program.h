#pragma once
#include <sys/types.h>

#include <csignal>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace mien {

/// A program of ours while it works: its standard error is read until it says something, then it gets a
/// signal. It starts with every signal at its default, whatever the shell around the test ignores, and is
/// killed when this object goes before it.
class RunningProgram {
 public:
  /// Starts `program` in `folder`; standard input and output are /dev/null. Fails the test when it cannot
  /// start.
  RunningProgram(const std::string& program, std::vector<std::string> arguments,
                 const std::filesystem::path& folder);
  RunningProgram(const RunningProgram&) = delete;
  RunningProgram& operator=(const RunningProgram&) = delete;
  ~RunningProgram();

  /// Waits until standard error holds `text`. False when the program ends, or two minutes pass, before.
  [[nodiscard]] bool says(std::string_view text);
  void send(int signal) const;
  /// Waits for the end. @return exit code, or 128 + n when signal n ended it
  int wait();
  /// Standard error so far.
  [[nodiscard]] const std::string& err() const { return err_; }

 private:
  // False at the end of standard error, or when nothing came before the deadline of says().
  bool read_more(int timeout_ms);

  pid_t process_ = -1;
  int pipe_ = -1;
  std::string err_;
};

}  // namespace mien
