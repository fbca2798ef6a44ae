#include "running_program.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>

namespace mien {
namespace {

constexpr std::chrono::minutes kPatience{2};  // for a sign of life on a machine that does other things

}  // namespace

RunningProgram::RunningProgram(const std::string& program, std::vector<std::string> arguments,
                               const std::filesystem::path& folder) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) {
    ADD_FAILURE() << "no pipe";
    return;
  }
  posix_spawn_file_actions_t files;
  ::posix_spawn_file_actions_init(&files);
  ::posix_spawn_file_actions_addchdir_np(&files, folder.c_str());
  ::posix_spawn_file_actions_addopen(&files, 0, "/dev/null", O_RDONLY, 0);
  ::posix_spawn_file_actions_addopen(&files, 1, "/dev/null", O_WRONLY, 0);
  ::posix_spawn_file_actions_adddup2(&files, ends[1], 2);
  // A background job of a shell that is not interactive ignores SIGINT, and its children inherit that.
  posix_spawnattr_t attributes;
  ::posix_spawnattr_init(&attributes);
  sigset_t all, none;
  ::sigfillset(&all);
  ::sigemptyset(&none);
  ::posix_spawnattr_setsigdefault(&attributes, &all);
  ::posix_spawnattr_setsigmask(&attributes, &none);
  ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK);

  std::string name = program;
  std::vector<char*> argv = {name.data()};
  for (auto& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  const int failed = ::posix_spawn(&process_, program.c_str(), &files, &attributes, argv.data(), environ);
  EXPECT_EQ(failed, 0) << program << " does not start";
  if (failed != 0) process_ = -1;
  ::posix_spawn_file_actions_destroy(&files);
  ::posix_spawnattr_destroy(&attributes);
  ::close(ends[1]);
  pipe_ = ends[0];
}

RunningProgram::~RunningProgram() {
  send(SIGKILL);
  if (process_ > 0) ::waitpid(process_, nullptr, 0);
  if (pipe_ >= 0) ::close(pipe_);
}

bool RunningProgram::read_more(int timeout_ms) {
  pollfd ready{pipe_, POLLIN, 0};
  if (::poll(&ready, 1, timeout_ms) <= 0) return false;
  char block[4096];
  const ssize_t n = ::read(pipe_, block, sizeof block);
  if (n <= 0) return false;
  err_.append(block, static_cast<std::size_t>(n));
  return true;
}

bool RunningProgram::says(std::string_view text) {
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  while (err_.find(text) == std::string::npos) {
    const auto left =
        std::chrono::ceil<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now());
    if (left.count() <= 0 || !read_more(static_cast<int>(left.count()))) return false;
  }
  return true;
}

void RunningProgram::send(int signal) const {
  if (process_ > 0) ::kill(process_, signal);
}

int RunningProgram::wait() {
  if (process_ <= 0) return -1;
  while (read_more(-1)) {
  }
  int status = 0;
  ::waitpid(process_, &status, 0);
  process_ = -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace mien
